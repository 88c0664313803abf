# Thin over CMakePresets.json. ccache is used where it is installed.
PREFIX ?= /usr/local
JOBS := $(shell nproc)
SFUMATO_TEST_DATA ?= ../shared/data
CCACHE := $(if $(shell command -v ccache),-DCMAKE_CXX_COMPILER_LAUNCHER=ccache -DSFUMATO_PRECOMPILE=OFF -DSFUMATO_UNITY=OFF)
export CCACHE_BASEDIR ?= $(CURDIR)

configure = cmake --preset $(1) $(CCACHE)
build = $(configure) && cmake --build build/$(1)
# Mesa repeats no warning for a shader that it finds in its cache, and any GL message fails a test: each run starts
# with an empty cache of its own.
check = rm -rf build/$(1)/shader_cache build/$(1)/shaders && MESA_SHADER_CACHE_DIR=$(CURDIR)/build/$(1)/shader_cache \
  ctest --test-dir build/$(1) --output-on-failure --no-tests=error --parallel $(JOBS)

.DEFAULT_GOAL := all
.PHONY: all release site paper-figures command python paraview paraview-test demo test bench bench-scale atlas eval-denoise eval-layers eval-normals eval-relief eval-shadows eval-sheets eval-soft eval-strokes eval-surface asan tsan portability gpu-report soak fuzz format install deb container tarball wheel uninstall clean help

help:  ## the targets
	@sed -n 's/^\([a-z-]*\):.*## /\1: /p' Makefile | awk -F: '{ printf "  %-14s%s\n", $$1, $$2 }'

all:  ## build/release, all of it
	@$(call build,release)

command:  ## build/release/bin/sfumato
	@$(call configure,release) && cmake --build build/release --target sfumato

python:  ## the package in build/release/python
	@$(call configure,release) -DSFUMATO_PYTHON=ON && cmake --build build/release --target python
	@echo "export PYTHONPATH=$(CURDIR)/build/release/python"

paraview:  ## the plugin for ParaView in build/release/paraview, where ParaView is installed (scripts/install-deps --paraview)
	@$(call configure,release) -DSFUMATO_PARAVIEW=ON && cmake --build build/release --target sfumato_paraview

paraview-test:  ## its tests, with a display of their own
	@$(call configure,test) -DSFUMATO_PARAVIEW=ON && cmake --build build/test --target sfumato sfumato_paraview
	@ctest --test-dir build/test --output-on-failure --label-regex paraview

demo: command  ## every technique on a synthetic scan, or on FILE
	@scripts/demo "$$FILE"

test:  ## warnings as errors, then every test
	@$(call build,test)
	@$(call check,test)

bench: all  ## BENCH=group (points, io, ...) or all: ours against the peers
	@cmake --build build/release --target sfumato_benchmarks
	@/usr/bin/python3 bench/run.py $(BENCH)

SCAN ?= $(SFUMATO_TEST_DATA)/autzen_full.laz
TILES ?= 10
bench-scale: all  ## TILES copies of SCAN (LAS or LAZ) built to one COPC file, drawn, and moved in a window
	@test -e "$(SCAN)" || { echo "bench-scale: SCAN=$(SCAN) is not there; name a LAS or LAZ file"; exit 1; }
	@cmake --build build/release --target sfumato_benchmarks
	@/usr/bin/python3 bench/scale.py "$(SCAN)" $(TILES) out/scale build/release

ATLAS ?= ../shared/atlas
atlas: command  ## the first pictures of labelled public scans (ATLAS=folder), with figures; ARGS="--half develop|closed|all"
	@/usr/bin/python3 bench/atlas/atlas.py --atlas "$(ATLAS)" $(ARGS)

eval-denoise: all  ## denoise against the truth of synthetic scenes and clean scans; ARGS=--quick for a short look
	@cmake --build build/release --target eval_denoise
	@build/release/bin/eval_denoise --data "$(SFUMATO_TEST_DATA)" $(ARGS)

eval-layers: all  ## layers against every crossing of every ray through nested tori, and through pairs of surfaces
	@cmake --build build/release --target eval_layers
	@build/release/bin/eval_layers $(ARGS)

eval-normals: all  ## computed normals against those of the surfaces that were sampled, by noise
	@cmake --build build/release --target eval_normals
	@build/release/bin/eval_normals --data "$(SFUMATO_TEST_DATA)" $(ARGS)

eval-relief: all  ## relief of pictures against a ray-traced ambient occlusion
	@cmake --build build/release --target eval_relief
	@build/release/bin/eval_relief $(ARGS)

eval-shadows: all  ## resolutions of the light map against the shadow of a sphere
	@cmake --build build/release --target eval_shadows
	@build/release/bin/eval_shadows out/shadow_resolution.png

eval-sheets: all  ## thin sheets sampled on both sides: which side pictures show
	@cmake --build build/release --target eval_sheets
	@build/release/bin/eval_sheets $(ARGS)

eval-soft: all  ## soft against its closed forms, and its share of points by density
	@cmake --build build/release --target eval_soft
	@build/release/bin/eval_soft $(ARGS)

eval-strokes: all  ## strokes of a wall that stands still, measured anew in every frame
	@cmake --build build/release --target eval_strokes
	@build/release/bin/eval_strokes --part still

paper-figures: all  ## every figure and table of the papers (docs/papers.md) into docs/images and out/paper-figures
	@cmake --build build/release --target eval_denoise eval_strokes eval_shadows eval_surface gen_isosurface sfumato_benchmarks
	@scripts/paper-figures

eval-surface: all  ## surface and splats against the truth of meshes and synthetic scenes
	@cmake --build build/release --target eval_surface
	@build/release/bin/eval_surface --data "$(SFUMATO_TEST_DATA)" $(ARGS)

asan:  ## every test under the address and undefined behaviour sanitizers
	@$(call build,asan)
	@export LSAN_OPTIONS=suppressions=$(CURDIR)/tests/leaks.txt:print_suppressions=0 && \
	  $(call check,asan) --label-regex unit
	@# Mesa leaves 240 bytes a context behind, and is unloaded before anybody could tell that they are its.
	@export ASAN_OPTIONS=detect_leaks=0 && $(call check,asan) --label-exclude unit

tsan:  ## the tests of reading, and of the loader of the window, under the thread sanitizer, without GL
	@$(call configure,tsan) && cmake --build build/tsan --target sfumato_decoder io_test view_test
	@# That one limits the address space, of which the sanitizer wants all.
	@SFUMATO_THREADS=4 TSAN_OPTIONS=exitcode=66 build/tsan/bin/io_test --gtest_brief=1 \
	  --gtest_filter=-Laz.TakesNoMemoryOnTheWordOfAHeader
	@# Not analysis_test and copc_test: the sanitizer does not see how a library that it did not compile (TBB) orders its threads.
	@SFUMATO_THREADS=4 TSAN_OPTIONS=exitcode=66 build/tsan/bin/view_test --gtest_brief=1

fuzz:  ## every parser under libFuzzer and sanitizers (clang), FUZZ_SECONDS=60 each, FUZZ="las laz ..."; then 10,000 damaged files a format
	@$(call configure,fuzz) && cmake --build build/fuzz --target sfumato_fuzz write_seeds
	@$(call configure,test) && cmake --build build/test --target damage_test
	@scripts/fuzz

portability:  ## tests of passes and techniques and golden pictures on every OpenGL 4.5 that this machine can have
	@$(call configure,test) && cmake --build build/test --target passes_test every_technique_test golden_test sfumato
	@scripts/portability

gpu-report: all  ## what this machine's OpenGL draws and how fast: tests, pictures, frames, 1e9 points; ARGS="--levels MILLIONS"
	@$(call configure,test) && cmake --build build/test
	@scripts/gpu-report $(ARGS)

soak:  ## the window under random input for MINUTES (10), SEED (1); PRESET=asan: under the address sanitizer
	@$(call configure,$(or $(PRESET),test)) && cmake --build build/$(or $(PRESET),test) --target sfumato_soak
	@export ASAN_OPTIONS=detect_leaks=0 && xvfb-run -a -s '-screen 0 1280x720x24' \
	  build/$(or $(PRESET),test)/bin/sfumato_soak --minutes $(or $(MINUTES),10) --seed $(or $(SEED),1)

format:  ## clang-format over the C++
	@find src tests bench examples include -name '*.cpp' -o -name '*.h' 2>/dev/null | xargs clang-format -i

install: all  ## command, manual page, completions, Python and CMake packages, documentation below PREFIX
	@cmake --install build/release --prefix "$(PREFIX)"

deb:  ## Debian packages in build/deb: sfumato, libsfumato-dev, python3-sfumato
	@scripts/deb

container:  ## as root, after make deb: the container's file system, tested, in build/container
	@scripts/container

tarball:  ## build/tarball: the command with its libraries and software OpenGL, for Linux without installing
	@scripts/tarball $(CCACHE)

wheel:  ## build/wheel: the Python package with its libraries and software OpenGL, for pip; proved by scripts/check-wheel
	@scripts/wheel $(CCACHE)

uninstall:  ## removes what the last install put into place
	@test -f build/release/install_manifest.txt || { echo "nothing was installed from this checkout" >&2; exit 1; }
	@xargs -d '\n' rm -fv <build/release/install_manifest.txt
	@# Folders of our own that are empty now.
	@sed -n 's|\(.*/sfumato\)/.*|\1|p' build/release/install_manifest.txt | sort -u | while read -r folder; do \
	  [ ! -d "$$folder" ] || find "$$folder" -depth -type d -empty -delete; done

site:  ## the documentation as searchable pages in build/site (Debian package mkdocs)
	@scripts/site

release:  ## VERSION=1.2.3 of the checkout: every check, then tarball, checksums and notes in build/release-VERSION
	@scripts/release "$(VERSION)"

clean:  ## removes build/, out/ and ./sfumato
	@rm -rf build out sfumato
