# What tests/run and tests/more share: steps that are timed, of which none hides those behind it; what was left out and
# why is said at the end. Sourced in the workspace's folder.

TOOLCHAIN=$(sed -n 's/^channel = "\(.*\)"/\1/p' rust-toolchain.toml)
TARGET=thumbv7em-none-eabihf
BUILT=${CARGO_TARGET_DIR:-$PWD/target}
# All that is for the PC. The same everywhere: with other members, dependencies have other features and everything is
# compiled again.
MEMBERS=(-p host -p identification -p recording -p simulation -p shared -p tests -p pendulum-rig-python)
# Whole builds are quicker without increments, without lines for a debugger, and with each crate in one piece: fits then
# take 7 % less, too.
export CARGO_INCREMENTAL=${CARGO_INCREMENTAL:-0} CARGO_PROFILE_DEV_CODEGEN_UNITS=1 CARGO_PROFILE_TEST_CODEGEN_UNITS=1
export CARGO_PROFILE_DEV_DEBUG=false CARGO_PROFILE_TEST_DEBUG=false
# Clippy compiles what it has looked at, so that nothing is compiled for its sake alone: as quickly as rustc by itself, and
# to programs as quick. Not for the firmware, whose images are those that everybody builds.
LINTED=(env RUSTC_WORKSPACE_WRAPPER=clippy-driver CLIPPY_ARGS=-Dwarnings__CLIPPY_HACKERY__)
# Where the processor has AVX2, several lanes of a simulation share its registers: diagnoses take a fifth less, with the same
# results to the last bit, because nothing is contracted. Released programs run anywhere and do without.
if grep -qw avx2 /proc/cpuinfo 2> /dev/null; then
    export CARGO_TARGET_X86_64_UNKNOWN_LINUX_GNU_RUSTFLAGS="-C target-feature=+avx2"
fi
BEGAN=$SECONDS
# Steps run in subshells, so that what they note must lie in files.
NOTES=$(mktemp -d)
trap 'rm -rf "$NOTES"' EXIT
touch "$NOTES"/{passed,failed,skipped}

# step WHAT COMMAND…: runs a command, says how long it took, and goes on whether it failed or not.
step() {
    local what=$1 began=$SECONDS n_skipped
    n_skipped=$(wc -l < "$NOTES/skipped")
    shift
    echo "== $what"
    # In a subshell of its own, because errexit is off in whatever a condition calls.
    set +e
    (set -e; "$@")
    local code=$?
    set -e
    local took
    took=$(minutes $((SECONDS - began)))
    if ((code != 0)); then
        echo "$took  $what (exit code $code)" >> "$NOTES/failed"
        echo "FAILED: $what, after $took (exit code $code)" >&2
    elif (($(wc -l < "$NOTES/skipped") == n_skipped)); then
        echo "$took  $what" | tee -a "$NOTES/passed"
    fi
}

# Like `step`, for what everything behind it needs.
needed_step() {
    step "$@"
    [ ! -s "$NOTES/failed" ] || finish
}

# skip WHAT WHY: notes what this machine could not check, and what to install for it.
skip() {
    echo "   skipped: $1: $2"
    echo "$1: $2" >> "$NOTES/skipped"
}

# The last word: what passed, what was skipped and why, what failed.
finish() {
    local took
    took=$(minutes $((SECONDS - BEGAN)))
    echo
    echo "== passed"
    cat "$NOTES/passed"
    if [ -s "$NOTES/skipped" ]; then
        echo "== skipped"
        cat "$NOTES/skipped"
    fi
    if [ -s "$NOTES/failed" ]; then
        echo "== FAILED" >&2
        cat "$NOTES/failed" >&2
        echo "failed, in $took" >&2
        exit 1
    fi
    if [ -s "$NOTES/skipped" ]; then
        echo "everything that this machine can check passed in $took; see what was skipped"
    else
        echo "all checks passed in $took"
    fi
    exit 0
}

minutes() {
    printf '%d min %02d s' $(($1 / 60)) $(($1 % 60))
}

give_up() {
    echo "$1" >&2
    exit 1
}

# needs PROGRAM PACKAGE [PROGRAM PACKAGE]…: installs Debian's packages for the programs that are missing.
needs() {
    local packages=()
    while (($#)); do
        command -v "$1" > /dev/null || packages+=("$2")
        shift 2
    done
    ((${#packages[@]} == 0)) || install_packages "${packages[@]}"
}

# Debian's packages; on other systems it only says what is needed.
install_packages() {
    local root=() wish="as root: apt-get install $*"
    command -v apt-get > /dev/null || give_up "install these with the system's package manager, then run this again: $*"
    if ((EUID != 0)); then
        root=(sudo)
        # Without a terminal nobody can type a password.
        [ -t 0 ] || root=(sudo -n)
        "${root[@]}" true || give_up "$* missing; $wish"
    fi
    "${root[@]}" apt-get update -q || give_up "$* missing, and apt-get update failed; $wish"
    "${root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-install-recommends "$@" ||
        give_up "$* missing, and apt-get install failed; $wish"
}

# Builds all for the PC, the Python package's library among it, and says folder and path of each test program. Built alone,
# with other features of their dependencies, they take minutes more.
programs() {
    "${LINTED[@]}" cargo build --locked "${MEMBERS[@]}" --lib --bins --tests \
        --message-format=json-render-diagnostics | python3 -c '
import json, os, sys
for line in sys.stdin:
    said = json.loads(line)
    if said.get("executable") and said["profile"]["test"]:
        print(os.path.dirname(said["manifest_path"]), said["executable"])'
}
