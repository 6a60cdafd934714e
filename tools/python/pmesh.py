# SPDX-License-Identifier: MIT
"""Decodes .pmesh files with the shared library, by ctypes; nothing to build.

    import pmesh
    mesh = pmesh.Decoder(open("bunny.pmesh", "rb").read())
    mesh.refine(faces=5000)
    mesh.positions            # float32, 3 for each vertex
    mesh.indices              # uint32, 3 for each face

Arrays are memoryviews of this module's own memory, which the next refine()
changes: numpy.asarray(mesh.positions) takes them without a copy. A decoder can
be fed as bytes come: Decoder() and feed(). What the calls mean is told in
pmesh_decode.h. The library is libpmesh.so.0 of the system, or PMESH_LIBRARY.
"""
import ctypes as c
import os
from typing import NamedTuple

NEED_DATA, MORE = 1, 2


class PmeshError(Exception):
    """A negative status: `status`, and `offset` and `rule` for bad bytes."""

    def __init__(self, status, offset=0, rule=""):
        text = _library.pmesh_status_text(status).decode()
        where = f"byte {offset}: {text} ({rule})" if rule else text
        super().__init__(where)
        self.status, self.offset, self.rule = status, offset, rule


def _struct(name, *fields):
    return type(name, (c.Structure,), {"_fields_": list(fields)})


# As in format/pmesh.h and decoder/pmesh_decode.h.
_Grid = _struct("Grid", ("origin", c.c_double * 3), ("step", c.c_double),
                ("bits", c.c_uint8))
_Attribute = _struct("Attribute", ("kind", c.c_int), ("set", c.c_uint8),
                     ("components", c.c_uint8), ("bits", c.c_uint8),
                     ("minimum", c.c_float * 4), ("scale", c.c_float * 4))
_Level = _struct("Level", ("bytes", c.c_uint64), ("faces", c.c_uint32),
                 ("mesh_vertices", c.c_uint32), ("vertices", c.c_uint32),
                 ("error", c.c_float), ("inflation", c.c_float),
                 ("rms", c.c_float), ("furthest", c.c_float))
_Error = _struct("Error", ("status", c.c_int), ("offset", c.c_uint64),
                 ("rule", c.c_char_p))
_Header = _struct(
    "Header", ("format_version", c.c_uint32), ("content_hash", c.c_uint64),
    ("bytes", c.c_uint64), ("profile", c.c_int), ("placement", c.c_int),
    ("base_coder", c.c_int), ("grid", _Grid), ("bounds", c.c_int32 * 3),
    ("faces", c.c_uint32), ("mesh_vertices", c.c_uint32),
    ("vertices", c.c_uint32), ("base_faces", c.c_uint32),
    ("base_mesh_vertices", c.c_uint32), ("base_vertices", c.c_uint32),
    ("material_count", c.c_uint32), ("attribute_count", c.c_uint32),
    ("attributes", _Attribute * 8), ("level_count", c.c_uint32),
    ("levels", _Level * 64), ("exact_bytes", c.c_uint64),
    ("memory", c.c_uint64), ("measured", c.c_int))
_Progress = _struct("Progress", ("bytes", c.c_uint64), ("faces", c.c_uint32),
                    ("levels", c.c_uint32), ("exact_vertices", c.c_uint32),
                    ("complete", c.c_int))
_Target = _struct("Target", ("faces", c.c_uint32), ("error", c.c_double),
                  ("bytes", c.c_uint64), ("max_ops", c.c_uint32))
_Range = _struct("Range", ("first", c.c_uint32), ("count", c.c_uint32))
_Changes = _struct("Changes", ("vertex_count", c.c_uint32),
                   ("face_count", c.c_uint32), ("vertices", _Range * 64),
                   ("faces", _Range * 64))
_View = _struct(
    "View", ("vertex_count", c.c_uint32), ("mesh_vertex_count", c.c_uint32),
    ("face_count", c.c_uint32), ("indices", c.c_void_p),
    ("positions_of", c.c_void_p), ("positions", c.c_void_p),
    ("values", c.c_void_p), ("value_stride", c.c_uint32),
    ("materials", c.c_void_p), ("error", c.c_float))
_Buffers = _struct(
    "Buffers", ("indices", c.c_void_p), ("index_size", c.c_uint32),
    ("positions", c.c_void_p), ("position_stride", c.c_size_t),
    ("attributes", c.c_void_p * 8), ("attribute_strides", c.c_size_t * 8))
_Hit = _struct("Hit", ("face", c.c_uint32), ("distance", c.c_double),
               ("weight", c.c_double * 3))


def _load():
    library = c.CDLL(os.environ.get("PMESH_LIBRARY", "libpmesh.so.0"))
    handle, p = c.c_void_p, c.POINTER
    for name, result, *arguments in (
            ("status_text", c.c_char_p, c.c_int),
            ("version", c.c_char_p),
            ("decoder_create", c.c_int, p(handle), c.c_void_p),
            ("decoder_destroy", None, handle),
            ("decoder_feed", c.c_int, handle, c.c_char_p, c.c_size_t),
            ("decoder_error", _Error, handle),
            ("decoder_header", c.c_int, handle, p(_Header)),
            ("decoder_progress", _Progress, handle),
            ("decoder_refine", c.c_int, handle, p(_Target), p(_Changes)),
            ("decoder_mesh", c.c_int, handle, p(_View)),
            ("decoder_bind", c.c_int, handle, p(_Buffers)),
            ("decoder_material_name", c.c_char_p, handle, c.c_uint32),
            ("decoder_bounds", c.c_int, handle, p(c.c_double * 3),
             p(c.c_double * 3)),
            ("decoder_raycast", c.c_int, handle, p(c.c_double * 3),
             p(c.c_double * 3), p(_Hit))):
        function = getattr(library, "pmesh_" + name)
        function.restype, function.argtypes = result, arguments
    return library


_library = _load()
version = _library.pmesh_version().decode()


class Changes(NamedTuple):
    """Ranges (first, count) that a refine() changed."""
    vertices: list
    faces: list
    more: bool


class Decoder:
    """A .pmesh stream, and the mesh that it shows."""

    def __init__(self, data=None):
        self._handle = c.c_void_p()
        self._check(_library.pmesh_decoder_create(c.byref(self._handle), None))
        self.header = None
        self._indices = self._positions = None
        self._values = []
        if data is not None:
            self.feed(data)
            self.refine()

    def __del__(self):
        if getattr(self, "_handle", None):
            _library.pmesh_decoder_destroy(self._handle)
            self._handle = None

    def _check(self, status):
        if status < 0:
            error = (_library.pmesh_decoder_error(self._handle)
                     if self._handle else _Error(status, 0, b""))
            raise PmeshError(status, error.offset, (error.rule or b"").decode())
        return status

    def feed(self, data):
        """Takes the next bytes; True once the file is complete."""
        status = _library.pmesh_decoder_feed(self._handle, bytes(data),
                                             len(data))
        header = _Header()
        if (self.header is None and _library.pmesh_decoder_header(
                self._handle, c.byref(header)) == 0):
            self._bind(header)
        return self._check(status) == 0

    def _bind(self, h):
        self._indices = (c.c_uint32 * (3 * h.faces))()
        self._positions = (c.c_float * (3 * h.vertices))()
        self._values = [
            (c.c_float * (a.components * h.vertices))()
            for a in h.attributes[:h.attribute_count]]
        buffers = _Buffers(indices=c.addressof(self._indices),
                           positions=c.addressof(self._positions))
        for i, values in enumerate(self._values):
            buffers.attributes[i] = c.addressof(values)
        self._check(_library.pmesh_decoder_bind(self._handle,
                                                c.byref(buffers)))
        self.header = h

    @property
    def levels(self):
        return list(self.header.levels[:self.header.level_count])

    @property
    def progress(self):
        return _library.pmesh_decoder_progress(self._handle)

    def refine(self, faces=0, error=0.0, bytes=0, max_ops=0):
        """Moves the visible mesh; None while there is none."""
        target, changes = _Target(faces, error, bytes, max_ops), _Changes()
        status = self._check(_library.pmesh_decoder_refine(
            self._handle, c.byref(target), c.byref(changes)))
        if status == NEED_DATA:
            return None
        return Changes(
            [(r.first, r.count)
             for r in changes.vertices[:changes.vertex_count]],
            [(r.first, r.count) for r in changes.faces[:changes.face_count]],
            status == MORE)

    def _view(self):
        view = _View()
        _library.pmesh_decoder_mesh(self._handle, c.byref(view))
        return view

    @property
    def face_count(self):
        return self._view().face_count

    @property
    def vertex_count(self):
        return self._view().vertex_count

    @property
    def error(self):
        """Distance of the visible mesh to the full one, model units."""
        return self._view().error

    @property
    def indices(self):
        return _cut(self._indices, "I", 3 * self.face_count)

    @property
    def positions(self):
        return _cut(self._positions, "f", 3 * self.vertex_count)

    def attribute(self, i):
        """Values of header.attributes[i]."""
        count = self.header.attributes[i].components * self.vertex_count
        return _cut(self._values[i], "f", count)

    def material_name(self, i):
        return _library.pmesh_decoder_material_name(self._handle, i).decode(
            errors="replace")

    def bounds(self):
        """(minimum, maximum) of the visible mesh, or None."""
        low, high = (c.c_double * 3)(), (c.c_double * 3)()
        if _library.pmesh_decoder_bounds(self._handle, c.byref(low),
                                         c.byref(high)) != 0:
            return None
        return tuple(low), tuple(high)

    def raycast(self, origin, direction):
        """(face, distance, weights) of what a ray meets first, or None."""
        hit, triple = _Hit(), c.c_double * 3
        if not _library.pmesh_decoder_raycast(
                self._handle, c.byref(triple(*origin)),
                c.byref(triple(*direction)), c.byref(hit)):
            return None
        return hit.face, hit.distance, tuple(hit.weight)


def _cut(array, form, count):
    return memoryview(array).cast("B").cast(form)[:count]
