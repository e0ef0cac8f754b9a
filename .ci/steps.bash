# The steps of .ci/run, a function each, and what they share. Sourced by it.

skip() { echo "$*"; exit 77; }

# What is not formatted is not run either: a file of tests that its crate's tests/all.rs does not name.
format() {
    local file
    cargo fmt --all --check
    for file in crates/*/tests/*.rs lab/*/tests/*.rs; do
        [[ "$file" == */all.rs ]] || grep -qx "mod $(basename "$file" .rs);" "$(dirname "$file")/all.rs" ||
            { echo "$file is not in $(dirname "$file")/all.rs: its tests do not run"; exit 1; }
    done
}

# No house above its ceiling of lines, and the core with no more numbers to choose than it had.
counts() { python3 .ci/count_houses.py --check; }

# The README's test command in two, without the examples, which clippy compiles. The workspace together switches on all features of the
# core, so all its tests are among these.
tests() {
    cargo test --workspace --tests --locked
    cargo test --workspace --doc --locked
}

# The core alone, with all that it can do: for who changes it.
tests_core() { cargo test -p itpms-core -p itpms-road -p itpms-paper --features itpms-road/serde,itpms-paper/serde --locked; }

lint() { cargo clippy --workspace --all-targets --all-features --locked -- -D warnings; }

# With clippy's features: what it has checked is checked.
docs() { RUSTDOCFLAGS="-D warnings" cargo doc --workspace --all-features --no-deps --locked; }

# Links, equation numbers and symbols of the derivations; that the validation page and README have the figures of docs/validation.toml.
pages() {
    python3 .ci/book.py
    python3 .ci/validation.py
}

# The documentation as a book. Building mdbook takes minutes, so it is used where it is or where it can be had quickly.
book() {
    command -v mdbook >/dev/null || install_package mdbook
    command -v mdbook >/dev/null || skip "mdbook is not installed (cargo install mdbook)"
    mdbook build docs --dest-dir "$(realpath -m "$target_dir/book")"
    [[ -s "$target_dir/book/math/identifiability.html" ]] || { echo "the book lacks a page"; exit 1; }
}

# Who wants no Parquet compiles none.
lean() {
    cargo check -p itpms-core --locked --no-default-features
    cargo check -p itpms-can-log --locked
    cargo check -p itpms-data --locked --no-default-features
    cargo check -p itpms --locked --no-default-features
}

# Every published crate as it would be published, with its README and both licences.
package() {
    local unpublished exclude=() name archive
    unpublished="$(crates 'p["publish"] == []')"
    for name in $unpublished; do exclude+=(--exclude "$name"); done
    rm -rf "$target_dir/package"
    cargo package --workspace "${exclude[@]}" --no-verify --locked --allow-dirty
    for archive in "$target_dir"/package/*.crate; do
        for name in README.md LICENSE-MIT LICENSE-APACHE; do
            tar -tzf "$archive" | grep "/$name$" >/dev/null || { echo "$archive lacks $name"; exit 1; }
        done
    done
}

# The names of the crates of which cargo's description p says this, in Python.
crates() {
    cargo metadata --no-deps --format-version 1 --locked |
        python3 -c "import json, sys; print(*(p['name'] for p in json.load(sys.stdin)['packages'] if $1))"
}

# What a published crate offered in the newest release it offers still, or its version says that it does not.
semver() {
    local tag name packages=()
    tag="$(git describe --tags --abbrev=0 --match 'v*' 2>/dev/null)" || skip "there is no release (a tag v*) to compare with"
    command -v cargo-semver-checks >/dev/null || skip "cargo-semver-checks is not installed (cargo install cargo-semver-checks)"
    for name in $(crates 'p["publish"] != [] and any("lib" in t["kind"] for t in p["targets"])'); do packages+=(-p "$name"); done
    cargo semver-checks --baseline-rev "$tag" "${packages[@]}"
}

# Which lines the tests run: a table, and lcov.info in the target folder.
coverage() {
    command -v cargo-llvm-cov >/dev/null || skip "cargo-llvm-cov is not installed (cargo install cargo-llvm-cov)"
    CARGO_TARGET_DIR="$target_dir/coverage" cargo llvm-cov --workspace --tests --locked --lcov --output-path "$target_dir/lcov.info"
    CARGO_TARGET_DIR="$target_dir/coverage" cargo llvm-cov report --summary-only
}

# The oldest compiler that Cargo.toml promises, with all features.
msrv() {
    local version
    version="$(sed -n 's/^rust-version = "\(.*\)"/\1/p' Cargo.toml)"
    rustup toolchain list | grep -q "^$version" || one_at_a_time timeout 300 rustup toolchain install "$version" --profile minimal ||
        skip "Rust $version cannot be fetched"
    CARGO_TARGET_DIR="$target_dir/msrv" cargo "+$version" check --workspace --all-features --locked
}

# Every feature of the published crates by itself.
features() {
    command -v cargo-hack >/dev/null || skip "cargo-hack is not installed (cargo install cargo-hack)"
    cargo hack check --each-feature --no-dev-deps --ignore-private --workspace
}

# What deny.toml says of licences and sources, without cargo-deny.
licences() { python3 .ci/licences.py; }

# The README's first command, but with all features, which are compiled already, and the files that it promises to leave behind.
demo() {
    cargo build --release --locked
    local out="$target_dir/ci-demo"
    rm -rf "$out"
    cargo run --release --locked -- demo --out "$out"
    ls -l "$out"
    find "$out" -name '*.html' -size +10k | grep -q . || { echo "demo left no report of more than 10 kB"; exit 1; }
    find "$out" -name '*.csv' -size +1k | grep -q . || { echo "demo left no csv of more than 1 kB"; exit 1; }
}

# The command lines of README.md, docs/commands.md and other pages, run as printed.
commands() {
    cargo build --release --locked
    python3 .ci/commands.py "$target_dir/release" "$target_dir/ci-commands"
}

# A refactoring leaves every number as it was (the file's own comment says how to write it anew after a change of behavior).
golden_trace() {
    cargo build --release --locked
    cargo build --release --locked -p itpms-bench --example trace
    python3 .ci/golden_trace.py "$target_dir/release"
}

# A few seeds tell a broken estimator from a working one, not a good one from a better one: see .ci/score.py.
score() {
    cargo build --release --locked
    local score=("$target_dir/release/itpms-lab" --quiet score --json)
    "${score[@]}" --seeds 8 | python3 .ci/score.py
    "${score[@]}" --row detection --only "one wheel" --seeds 4 | python3 .ci/score.py
}

# Every malfunction of the sensors in fifty everyday drives each: an hour and more.
malfunctions() {
    cargo build --release --locked
    "$target_dir/release/itpms-lab" --quiet malfunctions --drives 50
}

# One table by which a change of the estimator is judged, half an hour on two cores, in panel.md and panel.json of the target folder;
# `.ci/panel.py --compare before.json after.json` holds two of them side by side.
panel() { panel_of panel "$@"; }

# The same from fewer drives and without what seldom changes: five minutes.
panel_quick() { panel_of panel_quick --quick; }

panel_of() {
    local name="$1" firmware=()
    shift
    cargo build --release --locked
    example itpms-bench sizes drive
    if has_firmware_tools; then
        firmware=(--firmware "cd examples/firmware && cargo run --quiet --locked --target-dir '$(realpath -m "$target_dir/firmware")'")
    fi
    python3 .ci/panel.py "$target_dir/release" -o "$target_dir/$name.json" "${firmware[@]}" "$@" | tee "$target_dir/$name.md"
}

# Half an hour in which nothing is wrong: nothing may be reported. (That a killed run goes on is among the tests.)
soak() {
    cargo build --release --locked
    local out="$target_dir/ci-soak"
    rm -rf "$out"
    "$target_dir/release/itpms-lab" --quiet soak --hours 0.5 --drive-s 600 --out "$out"
    python3 -c 'import json, sys; sums = json.load(open(sys.argv[1])); sys.exit(sums["drives"] != 3 or sums["false_warnings"] > 0)' \
        "$out/summary.json" || { echo "warned of something, though nothing was wrong"; exit 1; }
}

# Of each kind of test one of UN R141's: a puncture, a diffusion, an unplugged sensor. Some 80 minutes of driving.
certify() {
    cargo build --release --locked
    "$target_dir/release/itpms-lab" --quiet certify --quick --only un-r141 --json |
        python3 -c '
import json, sys
outcomes = json.load(sys.stdin)["outcomes"]
for outcome in outcomes:
    print(outcome["name"], outcome["verdict"], outcome["warned_after_s"], sep="  ")
sys.exit(len(outcomes) != 3 or any(outcome["verdict"] != "pass" for outcome in outcomes))'
}

# What a car takes of a controller in f32: stack, building it where it lies and with samples, and no flash for its memory. And the core's
# examples as its page has them.
stack() {
    local name
    example itpms-bench stack
    "$target_dir/release/examples/stack" --most 8 24
    # As a controller has it: with a feature's second method a car's memory is not all zeros.
    cargo build --release --locked -p itpms-core --example static_car
    # All of nm's lines are read: with -q, grep would end first and nm complain.
    nm -C "$target_dir/release/examples/static_car" | grep ' [bB] static_car::CAR$' ||
        { echo "a car that is not configured is not all zeros: it does not lie in .bss"; exit 1; }
    for name in one_wheel puncture static_car wheel_speeds own_evidence; do
        cargo run --release --locked -p itpms-core --example "$name"
    done
}

# The core on a microcontroller: no heap, no operating system.
bare_metal() {
    local triple=thumbv7em-none-eabihf
    has_target "$triple" || skip "target $triple is not there"
    cargo check -p itpms-core -p itpms-road -p itpms-paper --locked --target "$triple"
    cargo check -p itpms-core -p itpms-road -p itpms-paper --locked --target "$triple" --features itpms-road/serde,itpms-paper/serde
}

# A whole car on a Cortex-M4F under QEMU: it warns, and takes the instructions, stack and flash that are checked in.
firmware() {
    local built profile flags program
    has_firmware_tools || skip "what the firmware needs is not there"
    built="$(realpath -m "$target_dir/firmware")"
    # From its own folder, whose .cargo/config.toml says how it is linked and run. The profile `small` is `dev` for size; told so, cargo
    # finds the drive's simulation compiled.
    for profile in dev small; do
        flags=()
        [[ $profile == dev ]] || flags=(--config 'profile.dev.opt-level="s"')
        (cd examples/firmware && for program in car wheels; do
            timeout 900 cargo run --quiet --locked --bin "$program" "${flags[@]}" --target-dir "$built"
        done) | python3 .ci/firmware.py "$profile"
    done
}

# QEMU and the target of a Cortex-M4F, which is fetched if it can be.
has_firmware_tools() {
    command -v qemu-system-arm >/dev/null || install_package qemu-system-arm
    command -v qemu-system-arm >/dev/null || { echo "QEMU for ARM is not installed (qemu-system-arm)"; return 1; }
    has_target thumbv7em-none-eabihf
}

# Nothing that a controller calls can panic: a program whose panic handler does not link. That a panic would be found is tried, too.
no_panic() {
    local triple=thumbv7em-none-eabihf log
    has_target "$triple" || skip "target $triple is not there"
    CARGO_TARGET_DIR="$(realpath -m "$target_dir/no-panic")" log="$(realpath -m "$target_dir/no-panic.txt")"
    export CARGO_TARGET_DIR
    cd no-panic
    cargo build --release --locked || { echo "something can panic; where: see docs/reliability.md"; exit 1; }
    if cargo build --release --locked --features left >"$log" 2>&1 || ! grep -q a_panic_is_left "$log"; then
        tail -n 20 "$log"
        echo "a panic that was put in was not found"
        exit 1
    fi
    echo "no panic is left in configuring a car, its samples, its calibration and its report"
}

# The C library: its header is that of the sources, nothing but itpms_* is to be seen in it and nothing in it panics; the example prints
# the numbers of `estimate`, on the host, under valgrind and on a Cortex-M4F under QEMU. (Its tests from C are among the tests.)
capi() {
    local out triple library precision name gcc=(-std=c99 -Wall -Wextra -pedantic -Werror -O2 -I crates/itpms-capi/include) board=()
    out="$(realpath -m "$target_dir/ci-capi")"
    mkdir -p "$out"
    command -v gcc >/dev/null || skip "gcc is not installed"
    header_is_current "$out" || echo "SKIPPED: cbindgen cannot be had: that itpms.h is that of the sources is not checked"
    cargo build --release --locked
    "$target_dir/release/itpms" -q lab simulate drive-puncture --seed 1 -o "$out/drive.csv" --vehicle-out "$out/car.toml"
    "$target_dir/release/itpms" -q estimate "$out/drive.csv" --vehicle "$out/car.toml" -o "$out/est.csv" >/dev/null
    "$target_dir/release/itpms" -q lab simulate examples/firmware/wheels.toml --seed 2 -o "$out/wheels.csv" --vehicle-out "$out/wheels.toml"
    triple="$(rustc -vV | sed -n 's/^host: //p')"
    for precision in f64 f32; do
        library="$(.ci/capi-library "$triple" "$precision")"
        for name in pressures wheels; do
            gcc "${gcc[@]}" "-DITPMS_${precision^^}" examples/c/{$name,vehicle_file}.c "$library" -lm -o "$out/$name-$precision"
        done
        "$out/pressures-$precision" "$out/drive.csv" "$out/car.toml" >"$out/$precision.csv"
        "$out/wheels-$precision" "$out/wheels.csv" "$out/wheels.toml" 60 >"$out/wheels-$precision.csv"
        for name in contract wheels_contract; do
            gcc "${gcc[@]}" "-DITPMS_${precision^^}" "crates/itpms-capi/tests/c/$name.c" "$library" -lm -o "$out/$name-$precision"
            "$out/$name-$precision"
        done
    done
    head -n 3001 "$out/drive.csv" >"$out/short.csv"
    command -v valgrind >/dev/null || install_package valgrind
    if command -v valgrind >/dev/null; then
        valgrind --quiet --error-exitcode=9 --leak-check=full "$out/pressures-f32" "$out/short.csv" "$out/car.toml" >/dev/null
        for name in contract wheels_contract; do
            valgrind --quiet --error-exitcode=9 --leak-check=full "$out/$name-f32"
        done
    else
        echo "SKIPPED: valgrind is not installed"
    fi
    command -v arm-none-eabi-gcc >/dev/null || { install_package gcc-arm-none-eabi && install_package libnewlib-arm-none-eabi; }
    if command -v arm-none-eabi-gcc >/dev/null && has_firmware_tools; then
        examples/c/board "$(.ci/capi-library thumbv7em-none-eabihf f32)" "$out"
        (cd "$out" && timeout 300 qemu-system-arm -machine mps2-an386 -nographic -kernel pressures.elf \
            -semihosting-config enable=on,target=native,arg=pressures,arg=short.csv,arg=car.toml >board.csv)
        board=("$out/board.csv")
        (cd "$out" && timeout 300 qemu-system-arm -machine mps2-an386 -nographic -kernel wheels.elf \
            -semihosting-config enable=on,target=native,arg=wheels,arg=wheels.csv,arg=wheels.toml,arg=60 >wheels-board.csv)
        cmp "$out/wheels-board.csv" "$out/wheels-f32.csv"
    else
        echo "SKIPPED: no arm-none-eabi-gcc or no QEMU: the example does not run on the board"
    fi
    python3 .ci/capi_judge.py "$out/est.csv" "$out/f64.csv" "$out/f32.csv" "${board[@]}"
}

# Whether itpms.h is what cbindgen makes of the sources; cbindgen is fetched if it can be.
header_is_current() {
    local cbindgen="$target_dir/ci-cbindgen/bin/cbindgen" version=0.29.4
    [[ "$("$cbindgen" --version 2>/dev/null)" == "cbindgen $version" ]] ||
        timeout 600 cargo install --quiet cbindgen --locked --version "$version" --root "$target_dir/ci-cbindgen" || return 1
    cbindgen="$(realpath "$cbindgen")"
    (cd crates/itpms-capi && "$cbindgen" --quiet -o "$1/itpms.h")
    diff -u crates/itpms-capi/include/itpms.h "$1/itpms.h" ||
        { echo "crates/itpms-capi/include/itpms.h is not that of the sources: cbindgen -o include/itpms.h in its folder"; exit 1; }
}

# The unit for simulation tools in both versions of FMI, by FMPy: valid, and with the numbers of `estimate`.
fmu() {
    local python
    python_with fmpy fmpy fmpy
    cargo build --release --locked
    "$python" .ci/fmu_judge.py "$target_dir/release/itpms" "$target_dir/ci-fmu"
}

# The second program for the published filters still computes what is checked in (that the first one agrees with it is
# among the tests).
transcription() {
    local python
    python_with numpy numpy numpy
    "$python" crates/itpms-paper/tests/data/published_filters/generate.py --compare
}

# MDF4 both ways against another program.
asammdf() {
    local python
    python_with asammdf "asammdf, can" asammdf python-can
    example itpms-mdf4 mdf4_make mdf4_digest
    "$python" .ci/mdf4_judge.py "$target_dir/release/examples"
}

# Random descriptions of a bus and random frames, decoded and encoded by another program and by us.
cantools() {
    local python
    python_with cantools cantools cantools
    example itpms-can-log dbc_lines
    "$python" .ci/cantools_judge.py "$target_dir/release/examples/dbc_lines"
}

# One drive through every format, written by the formats' own Python libraries: the estimates are the same.
formats() {
    local python
    python_with formats "asammdf, can, cantools, duckdb, jsonschema, mcap, numpy, polars, pyarrow" \
        asammdf python-can cantools duckdb jsonschema mcap numpy polars pyarrow
    cargo build --release --locked
    "$python" .ci/formats.py "$target_dir/release/itpms" "$target_dir/ci-formats-drives"
    # Every type, codec and encoding of Parquet that its writers have.
    "$python" .ci/parquet_judge.py "$target_dir/release/itpms" "$target_dir/ci-parquet"
    # MCAP of all three commands by Foxglove's own reader.
    "$python" .ci/mcap_judge.py "$target_dir/release/itpms" "$target_dir/ci-mcap"
    # The frames that the live monitor sends say in cantools what its lines of JSON say.
    "$python" .ci/live_judge.py "$target_dir/release/itpms"
}

# CAN logs that python-can writes are read, and what is written of them python-can reads.
python_can() {
    local python
    python_with python-can "can.io.mf4, asammdf" python-can asammdf
    example itpms-can-log can_copy
    "$python" .ci/python_can.py "$target_dir/release/examples/can_copy"
}

# The Python package, installed into a clean environment: its tests (the command's numbers to the last digit among them),
# its types, its style, its notebooks.
python() {
    local venv bin spark=()
    venv="$(realpath -m "$target_dir/ci-python")" bin="$venv/bin"
    # Without Java the tests of itpms.spark are skipped, and PySpark is a large download.
    if command -v java >/dev/null; then spark=("pyspark>=4,<5"); else echo "no Java: itpms.spark is not tested"; fi
    python3 -c 'import sys; sys.exit(sys.version_info < (3, 10))' || skip "Python 3.10 or later is not installed"
    rm -rf "$venv"
    { python3 -m venv "$venv" && timeout 600 "$bin/pip" install -q "maturin>=1.16,<2" numpy pandas pandas-stubs polars pyarrow matplotlib \
        tqdm types-tqdm pytest mypy ruff nbclient nbformat ipykernel "${spark[@]}"; } || skip "maturin and the test packages cannot be fetched"
    export PATH="$bin:$PATH"
    # Built while pip waits; the same flags as the other release builds.
    MATURIN_PEP517_ARGS="--locked" "$bin/pip" install -q --no-build-isolation --no-deps crates/itpms-python
    cargo build --release --locked
    export ITPMS="$(realpath "$target_dir/release/itpms")"
    "$bin/python" .ci/notebooks.py examples/notebooks
    cd crates/itpms-python
    "$bin/ruff" check .
    "$bin/ruff" check --ignore ANN,D ../../examples/{notebooks,fleet,spark}
    "$bin/ruff" format --check .
    "$bin/mypy"
    # Not from the source folder: the installed package is what is tested.
    "$bin/python" -P -m pytest -q -p no:cacheprovider
}

# Each reader of foreign files on the seeds and every finding so far, and on bytes that are made up from these in the same order every
# time: what a change is judged by must not be luck. New bytes for minutes: fuzz_anew.
fuzz() { fuzz_with -seed=1 -max_total_time=10; }
fuzz_anew() { fuzz_with -max_total_time=120; }
fuzz_with() {
    command -v cargo-fuzz >/dev/null || skip "cargo-fuzz is not installed (cargo install cargo-fuzz)"
    local target found directory seeds
    found="$(realpath -m "$target_dir/ci-fuzz")"
    rm -rf "$found"
    for target in $(cd fuzz && cargo fuzz list); do
        mkdir -p "$found/$target"
        seeds=()
        for directory in "fuzz/seeds/$target" "crates/itpms-$target/tests/data"; do
            [[ ! -d "$directory" ]] || seeds+=("$PWD/$directory")
        done
        if ! (cd fuzz && RUSTC_BOOTSTRAP=1 cargo fuzz run "$target" "$found/$target" "${seeds[@]}" -- \
            "$@" -timeout=10 -rss_limit_mb=1024 -print_final_stats=1) >"$found/$target.txt" 2>&1; then
            tail -n 60 "$found/$target.txt"
            exit 1
        fi
        echo "$target: $(grep number_of_executed_units "$found/$target.txt")"
    done
}

# What a release has for this machine, built and tried in an empty root: archive, Debian package, wheel. Three builds with all optimized at
# once, so it runs only when it is named.
dist() {
    rm -rf "$target_dir/ci-dist"
    .ci/dist "$target_dir/ci-dist"
}

# Two release builds in different folders have the same bytes. Takes as long as two release builds, so it runs only when it
# is named.
reproducible() { .ci/reproducible release; }

# Licences, bans, sources and advisories in full. Building cargo-deny takes longer than all the rest together, so it is
# used where it is.
deny() {
    command -v cargo-deny >/dev/null || skip "cargo-deny is not installed"
    cargo deny --all-features check licenses bans sources
    timeout 120 cargo deny fetch db || skip "the advisory database cannot be fetched; all else was checked"
    cargo deny --all-features check --disable-fetch advisories
}

# The demo's report opens from a file, draws, and has no complaints.
report() {
    local page browser
    [[ -d "$target_dir/ci-demo" ]] || skip "there is no report to open: the demo step comes first"
    page="$(find "$target_dir/ci-demo" -name '*.html' | sort | head -n 1)"
    [[ -n "$page" ]] || skip "there is no report to open: the demo step comes first"
    browser="$(find_browser)" || install_package chromium
    browser="$(find_browser)" || skip "no Chromium here and none to be had"
    python3 .ci/open_report.py "$browser" "$page"
}

# The pictures of README, docs and examples can be made anew. Those that are checked in were looked at, so none is replaced.
pictures() {
    local python
    find_browser >/dev/null || install_package chromium
    find_browser >/dev/null || skip "no Chromium here and none to be had"
    python_with pillow PIL pillow
    cargo build --release --locked
    "$python" .ci/pictures.py "$target_dir/release" "$target_dir/ci-pictures"
}

# The live monitor on a SocketCAN interface, which needs a kernel that has one: a virtual machine.
vcan() {
    cargo build --release --locked
    .ci/vcan/run "$target_dir/release/itpms" "$target_dir/ci-vcan"
}

# The live page in a browser: against a made-up car, and against the monitor with a replayed puncture.
dashboard() {
    command -v node >/dev/null && command -v npm >/dev/null || skip "node and npm are not installed"
    local browser tests built
    browser="$(find_browser)" || install_package chromium
    browser="$(find_browser)" || skip "no Chromium here and none to be had"
    timeout 60 "$browser" --headless --no-sandbox --disable-gpu --no-first-run --dump-dom 'data:text/html,<p>hello' 2>/dev/null |
        grep -q hello || skip "$browser does not run here"
    built="$(realpath -m "$target_dir")" tests="$(realpath -m "$target_dir/ci-dashboard")"
    rm -rf "$tests" && mkdir -p "$tests"
    cp crates/itpms-live/dashboard/e2e/*.{json,mjs} "$tests"
    (cd "$tests" && timeout 180 npm ci --ignore-scripts --no-audit --no-fund) || skip "the test packages cannot be fetched"
    cargo build --release --locked
    example itpms-live made_up_car
    cd "$tests"
    CHROMIUM="$(command -v "$browser")" ITPMS="$built/release/itpms" ITPMS_MADE_UP="$built/release/examples/made_up_car" npm test
}

# The pages that are written, and the live one, in a browser at the width of a phone and of a desk, light and dark: nothing serious by
# axe-core, all reached by Tab, silent, as wide as their window. Pictures to look at are left in ci-browser of the target folder.
browser() {
    command -v node >/dev/null && command -v npm >/dev/null || skip "node and npm are not installed"
    local found built tests made monitor address="" i
    found="$(find_browser)" || install_package chromium
    found="$(find_browser)" || skip "no Chromium here and none to be had"
    timeout 60 "$found" --headless --no-sandbox --disable-gpu --no-first-run --dump-dom 'data:text/html,<p>hello' 2>/dev/null |
        grep -q hello || skip "$found does not run here"
    built="$(realpath -m "$target_dir")" tests="$built/ci-browser" made="$built/ci-browser/pages"
    rm -rf "$tests" && mkdir -p "$made"
    cp crates/itpms-live/dashboard/e2e/*.json .ci/pages.mjs "$tests"
    (cd "$tests" && timeout 180 npm ci --ignore-scripts --no-audit --no-fund) || skip "the test packages cannot be fetched"
    cargo build --release --locked
    .ci/pages-make "$built/release/itpms" "$made"
    "$built/release/itpms" monitor --replay "$made/demo/drive.csv" --speed 4 --vehicle "$made/demo/car.toml" --http 127.0.0.1:0 \
        </dev/null >"$tests/monitor.txt" 2>&1 &
    monitor=$!
    for ((i = 0; i < 50; i++)); do
        address="$(grep -om1 'http://[0-9.:]*/' "$tests/monitor.txt" || true)"
        [[ -z "$address" ]] || break
        sleep 0.2
    done
    [[ -n "$address" ]] || { cat "$tests/monitor.txt"; kill "$monitor"; exit 1; }
    cd "$tests"
    CHROMIUM="$(command -v "$found")" node pages.mjs pictures pages/demo/report.html pages/{wheels,plot,check}.html \
        pages/{fleet,study}/index.html pages/certify.html "$address" || { kill "$monitor"; exit 1; }
    kill "$monitor"
}

find_browser() {
    local name
    for name in chromium chromium-browser google-chrome google-chrome-stable; do
        command -v "$name" && return 0
    done
    return 1
}

# Sets `python` to one that has these modules: the system's, else that of a virtual environment into which pip puts these packages.
python_with() {
    local venv="$target_dir/ci-$1" modules="$2"
    shift 2
    python=python3
    if ! "$python" -c "import $modules" 2>/dev/null; then
        python="$venv/bin/python"
        "$python" -c "import $modules" 2>/dev/null || { python3 -m venv "$venv" && timeout 300 "$venv/bin/pip" install -q "$@"; } ||
            skip "$* cannot be fetched"
    fi
}

# The target of a Cortex-M4F, which is fetched if it can be.
has_target() {
    [[ -d "$(rustc --print target-libdir --target "$1")" ]] || one_at_a_time timeout 180 rustup target add "$1" ||
        { echo "target $1 cannot be added"; return 1; }
}

# Tries to install a Debian package; never fails.
install_package() {
    [[ "${CI:-}" == true && "$(id -u)" == 0 ]] && command -v apt-get >/dev/null || return 0
    { one_at_a_time timeout 90 apt-get -qq update &&
        DEBIAN_FRONTEND=noninteractive one_at_a_time timeout 240 apt-get -qq -y install "$1"; } \
        </dev/null >/dev/null 2>&1 || echo "apt-get could not install $1"
}

# What two steps at a time must not do at the same time.
one_at_a_time() { flock "$target_dir/ci-installs" "$@"; }

# Builds examples of a crate for release together with the command: with the features that the command has the crates with, which are
# compiled already.
example() {
    local crate="$1" name names=()
    shift
    for name in "$@"; do names+=(--example "$name"); done
    cargo build --release --locked -p itpms -p itpms-lab -p "$crate" "${names[@]}"
}

