# SPDX-License-Identifier: MIT
# Build with `make`, look with `make demo`, test with `make test`; `make help`
# lists all. Variants live side by side: make config=sanitize check
# Respected: CC CXX CFLAGS CXXFLAGS LDFLAGS, DESTDIR PREFIX LIBDIR; WERROR=1
# makes warnings errors, V=1 shows the commands.

config ?= release
PREFIX ?= /usr/local
LIBDIR ?= $(PREFIX)/lib
JOBS ?= $(shell nproc 2>/dev/null || echo 2)

B := build/$(config)
soname := libpmesh.so.0
version := $(shell awk '/define PMESH_VERSION_/ { printf "%s%s", dot, $$3; \
  dot = "." }' format/pmesh.h)

opt_release := -O3 -DNDEBUG
opt_debug := -O0 -g
opt_sanitize := -O1 -g -fsanitize=address,undefined,float-cast-overflow \
  -fno-sanitize-recover=all
# These need clang: see fuzz, msan and coverage below. Comparisons of parsers are
# worth tracing; in the codec they are arithmetic and take half of the time.
no_cmp := -fno-sanitize-coverage=trace-cmp
opt_fuzz := -O2 -g -fsanitize=address,undefined,float-cast-overflow \
  -fno-sanitize-recover=all -fsanitize=fuzzer-no-link
opt_msan := -O1 -g -fsanitize=memory -fsanitize-memory-track-origins \
  -fno-sanitize-recover=all -fsanitize=fuzzer-no-link
opt_coverage := -O1 -g -fprofile-instr-generate -fcoverage-mapping
ifndef opt_$(config)
$(error config=$(config): there are release, debug, sanitize, fuzz, msan and \
  coverage)
endif

# -ffp-contract=off: the encoder's choices must not depend on the compiler.
shared_flags := -fPIC -pthread -fvisibility=hidden -ffp-contract=off -I. \
  $(opt_$(config)) $(if $(filter 1,$(WERROR)),-Werror)
c_flags := -std=c11 $(shared_flags) -Wall -Wextra -Wpedantic -Wshadow \
  -Wconversion -Wstrict-prototypes -Wmissing-prototypes -Wcast-qual \
  -Wwrite-strings -Wundef -Wvla $(CPPFLAGS) $(CFLAGS)
cxx_flags := -std=c++17 $(shared_flags) -Wall -Wextra $(CPPFLAGS) $(CXXFLAGS)
link_flags := -pthread $(filter -fsanitize=% -fprofile-instr%,$(opt_$(config))) \
  $(LDFLAGS)
posix := -D_POSIX_C_SOURCE=200809L
cgal := -isystem /usr/include/eigen3 -Wno-maybe-uninitialized
# Draco's archive, if there is one: its library allocates before main().
bridge_libs := $(if $(filter /%,$(shell $(CXX) -print-file-name=libdraco.a)),\
  -l:libdraco.a,-ldraco) -lmeshoptimizer -lz

units ?= $(wildcard tests/unit/*.c)
obj = $(patsubst %,$(B)/%.o,$(basename $(1)))
dec_obj := $(call obj,$(wildcard format/*.c decoder/*.c))
lib_obj := $(dec_obj) $(call obj,$(wildcard encoder/*.c))
tool_obj := $(call obj,$(wildcard tools/*.c tools/*.cpp))
shared_obj := $(filter-out $(B)/tools/pmesh.o,$(tool_obj))
unit_obj := $(call obj,$(units)) $(shared_obj)
golden := $(B)/golden_bake $(B)/golden_decode
reference := $(B)/reference $(B)/reference_agree
reference_obj := $(call obj,$(wildcard tests/reference/ref_*.c)) \
  $(B)/reference_tables.o
corrupt := $(B)/corrupt
damage := $(B)/damage
libs := $(B)/libpmesh.a $(B)/libpmesh-dec.a $(B)/libpmesh.so
targets := $(patsubst tests/fuzz/target_%.c,%,\
  $(wildcard tests/fuzz/target_*.c))
fuzzers := $(addprefix $(B)/fuzz/,$(targets))
libfuzzer := $(filter fuzz msan,$(config))

## all: libraries and program (default)
all: $(libs) $(B)/pmesh

$(B)/libpmesh.a: $(lib_obj)
$(B)/libpmesh-dec.a: $(dec_obj)
$(B)/libpmesh.so: $(lib_obj)
$(B)/pmesh: $(tool_obj) $(B)/libpmesh.a
$(B)/unit: $(unit_obj) $(B)/libpmesh.a
$(B)/train: $(B)/tests/train/train.o $(shared_obj) $(B)/libpmesh.a
$(B)/golden_bake: $(call obj,tests/golden/golden_bake.c \
  tests/golden/golden_mesh.c tests/unit/shapes.c tools/trig.c) $(B)/libpmesh.a
$(B)/golden_decode: $(B)/tests/golden/golden_decode.o $(B)/libpmesh-dec.a
$(B)/reference: $(B)/tests/reference/reference.o $(reference_obj)
$(B)/reference_agree: $(call obj,$(addprefix tests/,$(addprefix reference/,\
  agree.c author.c chunks.c compare.c mutate.c random_mesh.c) \
  golden/golden_mesh.c unit/shapes.c) tools/trig.c) $(reference_obj) \
  $(B)/libpmesh.a
$(damage): $(call obj,tests/damage/damage.c tests/unit/shapes.c tools/trig.c) \
  $(B)/libpmesh.a
$(corrupt): $(call obj,$(wildcard tests/corrupt/*.c) \
  tests/reference/chunks.c tests/golden/golden_mesh.c tests/unit/shapes.c) \
  $(reference_obj) $(shared_obj) $(B)/libpmesh.a
$(fuzzers): $(B)/fuzz/%: $(B)/tests/fuzz/target_%.o $(call obj,$(addprefix \
  tests/,$(addprefix fuzz/,fuzz.c pieces.c use.c) $(addprefix unit/,faces.c \
  float_faces.c lods.c shapes.c)) $(if $(libfuzzer),,tests/fuzz/driver.c) tools/trig.c) \
  $(B)/libpmesh.a
# Those of the libraries alone are C alone, as MSan wants it.
$(filter-out $(B)/fuzz/dec_% %/coder %/roundtrip \
  %/simplify,$(fuzzers)): \
  $(B)/tests/fuzz/import.o $(shared_obj)
# Where the checks are on, and random bytes are to be refused, nobody mends.
$(if $(libfuzzer),$(filter-out %/dec_raw,$(filter $(B)/fuzz/dec_% \
  $(B)/fuzz/tool_%,$(fuzzers)))): $(B)/tests/fuzz/mutator.o
$(libs) $(B)/pmesh $(B)/unit $(B)/train $(fuzzers): $(B)/objects.list

inputs = $(filter %.o,$^) $(filter %.a,$^)
quiet = $(if $(V),,@echo '  $@' && )
$(B)/%.a:
	$(quiet)rm -f $@ && $(AR) rcs $@ $(inputs)
$(B)/%.so:
	$(quiet)$(CC) -shared -Wl,-soname,$(soname) $(inputs) $(link_flags) -lm -o $@
$(B)/pmesh $(B)/unit $(B)/train $(corrupt):
	$(quiet)$(CXX) $(inputs) $(link_flags) $(bridge_libs) -lm -o $@
$(fuzzers):
	@mkdir -p $(@D)
	$(quiet)$(CXX) $(inputs) $(link_flags) $(if $(libfuzzer),\
	  -fsanitize=fuzzer) $(bridge_libs) -lm -o $@

$(golden) $(reference) $(damage):
	$(quiet)$(CC) $(inputs) $(link_flags) -lm -o $@

$(B)/%.o: %.c $(B)/c.flags
	@mkdir -p $(@D)
	$(quiet)$(CC) $(c_flags) $(if $(filter tools/% tests/%,$<),$(posix),\
	  $(if $(libfuzzer),$(no_cmp))) -MMD -MP -c $< -o $@
$(B)/%.o: %.cpp $(B)/cxx.flags | $(B)/found
	@mkdir -p $(@D)
	$(quiet)$(CXX) $(cxx_flags) $(if $(filter tests/%,$<),$(cgal)) \
	  -MMD -MP -c $< -o $@

# The reference decoder's tables come from the text, not from the code.
$(B)/reference_tables.c: SPEC.md tests/reference/tables.awk
	@mkdir -p $(@D)
	$(quiet)awk -f tests/reference/tables.awk SPEC.md >$@.new && mv $@.new $@
$(B)/reference_tables.o: $(B)/reference_tables.c $(B)/c.flags
	$(quiet)$(CC) $(c_flags) -MMD -MP -c $< -o $@

# One line on what is missing, instead of a compiler's pages.
$(B)/found:
	@mkdir -p $(@D)
	@tests/install-deps.sh --check build && touch $@

# Written only when they change: objects are rebuilt when the compiler or its
# flags are others, libraries and programs when a source came or went.
$(B)/c.flags: line = $(CC) $(c_flags) $(if $(libfuzzer),$(no_cmp))
$(B)/cxx.flags: line = $(CXX) $(cxx_flags)
$(B)/objects.list: line = $(lib_obj) $(tool_obj) $(unit_obj)
$(B)/c.flags $(B)/cxx.flags $(B)/objects.list: FORCE
	@mkdir -p $(@D)
	@echo '$(line)' | cmp -s - $@ || echo '$(line)' >$@
FORCE:

submake = $(MAKE) --no-print-directory \
  $(if $(filter -j% --jobserver%,$(MAKEFLAGS)),,-j$(JOBS))

## demo: bake a sample mesh, extract three levels, draw them
demo: deps
	+@$(submake) all
	@tests/demo.sh $(B)/pmesh build/demo

## test: everything that must pass, after installing what is missing
test: deps
	+@$(submake) check

## check: the same without installing anything
check:
	+@$(submake) all $(B)/unit $(golden) $(reference) $(corrupt) $(damage) \
	  $(fuzzers)
	@tests/run.sh $(B)

## unit: only the unit tests; T=name selects some
unit: $(B)/unit
	$< $(T)

## single: the decoder as two files, build/single/pmesh_decode.[ch]
single:
	@tools/amalgamate.sh build/single $(version)

## web: the npm package with the decoder as WebAssembly, build/web/pmesh
web:
	@tools/web/build.sh build/web/pmesh $(version)

## viewer: the page of `pmesh view`, build/web/viewer.html (Node and npm)
viewer: web
	@tools/web/viewer/build.sh build/web/pmesh build/web/viewer.html

## train: make the codec's starting tables anew from TRAIN_ON="a.obj b.obj"
train: $(B)/train
	TRAIN=$< tests/train/train.sh $(TRAIN_ON)

## check-deps: every #include follows the architecture
check-deps:
	@tests/check-deps.sh

## check-headers: every header compiles alone, public ones as C++ too
check-headers:
	@tests/check-headers.sh

## check-symbols: names, exports, imports and data of the libraries
check-symbols: $(libs)
	@tests/check-symbols.sh $(B)

## check-cross: the same results on other compilers and machines (tests/cross)
check-cross: cross-deps
	+@$(submake) $(corrupt)
	@CORRUPT=$(corrupt) tests/cross/all.sh build/cross

## check-web: the npm package in node, the viewer in a browser (tests/web)
check-web: web-deps
	+@$(submake) $(B)/pmesh
	@NPM=1 PMESH=$(B)/pmesh tests/web/run.sh

## check-reference: 10,000 files against a decoder made from SPEC.md alone
check-reference:
	+@$(submake) $(B)/pmesh $(reference)
	@PMESH=$(B)/pmesh FILES=10000 MENDED=2000 DAMAGED=500 \
	  tests/reference/run.sh

## check-damage: every prefix of 28 files, 500,000 flips, 100,000 edits
check-damage:
	+@$(submake) $(B)/pmesh $(damage)
	@PMESH=$(B)/pmesh LONG=1 tests/damage/run.sh

## check-faults: every allocation fails, 200 kills (tests/faults)
check-faults:
	+@$(submake) $(B)/pmesh
	@PMESH=$(B)/pmesh KILLS=200 STEP=1 tests/faults/run.sh
	@PMESH=$(B)/pmesh tests/faults/batch.sh 200 8

## check-gltf: scenes of tests/scene by Khronos' glTF validator (npm)
check-gltf:
	+@$(submake) $(B)/pmesh
	@cd tests/scene && npm install --silent --no-save --prefix \
	  $(CURDIR)/build/gltf gltf-validator@2.0.0-dev.3.10 \
	  @gltf-transform/cli@4 >/dev/null
	@PMESH=$(CURDIR)/$(B)/pmesh NODE_PATH=$(CURDIR)/build/gltf/node_modules \
	  VALIDATE="node tests/scene/validate.js" \
	  TRANSFORM=$(CURDIR)/build/gltf/node_modules/.bin/gltf-transform \
	  tests/scene/run.sh

## fuzz: one target under libFuzzer, T=dec_oneshot TIME=60 (tests/fuzz; clang)
## msan: the same with memory that was never written in view, T=, TIME=
fuzz msan: fuzz-deps
	+@$(submake) $(B)/pmesh
	+@$(submake) config=$@ CC=clang CXX=clang++ build/$@/fuzz/$(fuzz_target)
	@PMESH=$(B)/pmesh tests/fuzz/fuzz.sh build/$@/fuzz/$(fuzz_target) \
	  $(or $(TIME),60)
## afl: the same by AFL++, without sanitizers and mended checksums, T=, TIME=
afl: afl-deps
	+@$(submake) $(B)/pmesh
	+@$(submake) B=build/afl CC=afl-clang-fast CXX=afl-clang-fast++ \
	  build/afl/fuzz/$(fuzz_target)
	@PMESH=$(B)/pmesh tests/fuzz/afl.sh build/afl/fuzz/$(fuzz_target) \
	  $(or $(TIME),60)
fuzz_target = $(or $(T),$(error T=NAME says what to fuzz: $(targets)))

## fuzz-replay: what fuzzing found, and other odd files, to every target
fuzz-replay:
	+@$(submake) $(B)/pmesh $(fuzzers)
	@PMESH=$(B)/pmesh tests/fuzz/run.sh

## coverage: lines and branches that unit tests and fuzzing's files reach
coverage: fuzz-deps
	+@$(submake) config=coverage CC=clang CXX=clang++ build/coverage/unit \
	  $(fuzzers:$(B)/%=build/coverage/%)
	@tests/fuzz/coverage.sh build/coverage

## golden: write tests/golden anew; only for another version of the format
golden: $(golden)
	$(B)/golden_bake tests/golden
	$(B)/golden_decode tests/golden/*.pmesh >tests/golden/hashes.txt

## bench: all of the following, against other programs (tests/bench)
bench: bench-all
## bench-size: bytes of complete files, by part; draws size.svg
## bench-attribute-size: the same of meshes with attributes
## bench-rate: bytes against distance of every prefix; draws rate.svg
## bench-lod: distance at equal faces, against strict quadric order
## bench-quality: distance at equal faces, against CGAL and meshoptimizer
## bench-decode: time to decode, against Draco
## bench-lossless: cost of exact positions
## bench-skin: distance of skinned levels in five poses of an animation
## bench-attributes: attributes of simplified meshes, against meshoptimizer
## bench-refine: time and uploads of moving among decoded splits
## bench-web: time to decode in a browser, against Draco and native code
## bench-speed: speed and memory against other programs, and what they must be
## bench-scale: time and memory of 70,000 to 8 million faces (takes long)
## bench-time: time and memory of the commands
bench_programs := $(addprefix $(B)/bench_,attributes decode qem refine simplify speed)
bench-%: bench-deps
	+@$(submake) all $(bench_programs)
	@PMESH=$(B)/pmesh tests/bench/$*.sh
bench-web: web-deps
$(bench_programs): $(B)/bench_%: $(B)/tests/bench/bench_%.o
	$(quiet)$(CXX) $(inputs) $(link_flags) $(bench_libs) -o $@
$(B)/bench_attributes: $(B)/tests/bench/attribute_measure.o
$(B)/bench_simplify $(B)/bench_speed: $(B)/tests/bench/peers.o
$(B)/bench_speed: $(B)/tests/bench/parsers.o
$(B)/bench_attributes $(B)/bench_speed: $(shared_obj) $(B)/libpmesh.a
$(B)/bench_decode $(B)/bench_refine: $(B)/libpmesh-dec.a
openmesh := -lOpenMeshTools -lOpenMeshCore
$(B)/bench_attributes: bench_libs := $(bridge_libs)
$(B)/bench_decode: bench_libs := -ldraco
$(B)/bench_simplify: bench_libs := $(openmesh) -lmeshoptimizer -lgmp -lmpfr
$(B)/bench_speed: bench_libs := $(bridge_libs) $(openmesh) -ltinyobjloader \
  -lgmp -lmpfr

## deps: install the Debian packages that building and testing need
deps:
	@tests/install-deps.sh build test
## bench-deps: those that `make bench` needs
bench-deps:
	@tests/install-deps.sh build bench
## web-deps: those that `make web` and `make check-web` need
web-deps:
	@tests/install-deps.sh build web
## fuzz-deps: those that `make fuzz`, `msan` and `coverage` need
fuzz-deps:
	@tests/install-deps.sh build fuzz
## afl-deps: those that `make afl` needs
afl-deps:
	@tests/install-deps.sh build afl
## cross-deps: those that `make check-cross` needs
cross-deps:
	@tests/install-deps.sh cross

headers := format/pmesh.h encoder/pmesh_encode.h encoder/pmesh_guide.h \
  encoder/pmesh_inspect.h encoder/pmesh_session.h \
  encoder/pmesh_simplify.h \
  encoder/pmesh_scene_encode.h decoder/pmesh_decode.h decoder/pmesh_plan.h \
  decoder/pmesh_scene.h
lib := $(DESTDIR)$(LIBDIR)
include := $(DESTDIR)$(PREFIX)/include
bin := $(DESTDIR)$(PREFIX)/bin
share := $(DESTDIR)$(PREFIX)/share/pmesh
completions := $(DESTDIR)$(PREFIX)/share/bash-completion/completions
man := $(DESTDIR)$(PREFIX)/share/man/man1

## install: into PREFIX (/usr/local) below DESTDIR
install: all
	install -d $(bin) $(man) $(include) $(lib)/pkgconfig
	install -m 755 $(B)/pmesh $(bin)
	install -m 644 tools/pmesh.1 $(man)
	install -d $(share) $(completions)
	install -m 644 tools/pmesh.bash $(completions)/pmesh
	install -m 644 tools/python/pmesh.py tools/guide.md $(share)
	install -m 644 tools/guide.schema.json $(share)
	install -m 644 $(B)/libpmesh.a $(B)/libpmesh-dec.a $(lib)
	install -m 755 $(B)/libpmesh.so $(lib)/libpmesh.so.$(version)
	ln -sf libpmesh.so.$(version) $(lib)/$(soname)
	ln -sf $(soname) $(lib)/libpmesh.so
	if [ -e build/web/viewer.html ]; then \
	  install -m 644 build/web/viewer.html $(share); \
	else echo "no page for pmesh view: 'make viewer' makes it"; fi
	for h in $(headers); do sed 's|#include "[a-z]*/|#include "|' $$h \
	  >$(include)/$${h##*/}; done
	sed -e 's|@PREFIX@|$(PREFIX)|; s|@LIBDIR@|$(LIBDIR)|' \
	  -e 's|@VERSION@|$(version)|' tools/pmesh.pc.in >$(lib)/pkgconfig/pmesh.pc

## uninstall: remove what install put there
uninstall:
	rm -f $(bin)/pmesh $(man)/pmesh.1 $(share)/viewer.html
	rm -f $(completions)/pmesh $(share)/pmesh.py
	rm -f $(share)/guide.md $(share)/guide.schema.json
	rm -f $(addprefix $(include)/,$(notdir $(headers)))
	rm -f $(lib)/libpmesh.a $(lib)/libpmesh-dec.a $(lib)/libpmesh.so*
	rm -f $(lib)/pkgconfig/pmesh.pc

## clean: remove build/
clean:
	rm -rf build

## help: this list
help:
	@sed -n 's/^## //p' $(firstword $(MAKEFILE_LIST))

.PHONY: all demo test check unit single web viewer check-deps check-headers check-symbols bench
.PHONY: fuzz msan afl fuzz-replay coverage fuzz-deps afl-deps
.PHONY: check-cross check-reference check-gltf golden deps bench-deps cross-deps web-deps
.PHONY: check-web check-damage check-faults install
.PHONY: uninstall clean help FORCE
-include $(shell find $(B) -name '*.d' 2>/dev/null)
