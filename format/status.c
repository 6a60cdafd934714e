/* SPDX-License-Identifier: MIT */
#include "format/pmesh.h"

const char *pmesh_status_text(pmesh_status status)
{
    switch (status) {
    case PMESH_OK: return "done";
    case PMESH_NEED_DATA: return "more bytes are needed";
    case PMESH_MORE: return "more work is left";
    case PMESH_E_ARGUMENT: return "an argument is out of range";
    case PMESH_E_MEMORY: return "out of memory";
    case PMESH_E_LIMIT: return "larger than the limits allow";
    case PMESH_E_CANCELLED: return "cancelled";
    case PMESH_E_WRITE: return "writing failed";
    case PMESH_E_MAGIC: return "not a .pmesh file";
    case PMESH_E_VERSION: return "a newer or unknown format version";
    case PMESH_E_CORRUPT: return "the stream is damaged";
    case PMESH_E_CHECKSUM: return "a checksum does not match";
    case PMESH_E_UNSUPPORTED: return "the file needs a hook that is not there";
    case PMESH_E_NO_FACES: return "the mesh has no usable triangle";
    case PMESH_E_INDEX: return "a face index is out of range";
    case PMESH_E_NOT_FINITE: return "a position in use is not finite";
    }
    return "unknown status";
}

#define TEXT(x) #x
#define VERSION(a, b, c) TEXT(a) "." TEXT(b) "." TEXT(c)

const char *pmesh_version(void)
{
    return VERSION(PMESH_VERSION_MAJOR, PMESH_VERSION_MINOR,
                   PMESH_VERSION_PATCH);
}
