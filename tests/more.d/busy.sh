# Whatever kills, waits for a link, serves a page or runs in QEMU, 20 times at lowest priority while all cores are busy; days.
# BUSY_RUNS is another number of times, BUSY_TESTS a choice of test files. What keeps the cores busy leaves them little more
# than a hundredth; with BUSY_NICE=19 it has their priority, and they take hours. Broken off, it goes on where it was: what
# passed is noted, and counts as long as the test and the program are the same byte for byte.
n_runs=${BUSY_RUNS:-20}
KILLS="trust_files recording_files study"
LINKS="trust_link trust_recorder trust_recovery link_devices link_losses"
PAGES="page page_evidence page_http docs"
QEMU=$(cd tests/tests && basename -s .rs qemu_*.rs)
read -ra files <<< "${BUSY_TESTS:-$KILLS $LINKS $PAGES $(xargs <<< "$QEMU")}"

folder=$BUILT/busy
mkdir -p "$folder"
touch "$folder/passed"
programs > "$folder/programs"
export HOST_PROGRAM=$BUILT/debug/host

# of FILE: its package's folder, and its program.
of() {
    grep "/$1-[0-9a-f]*$" "$folder/programs" || true
}

# A test and the program that it runs, as they are now.
state_of() {
    echo "$1 $(cat "$(of "$1" | cut -d ' ' -f 2-)" "$HOST_PROGRAM" | sha256sum | cut -c -16)"
}

# once FILE: in its package, as cargo would.
once() {
    local package program
    read -r package program <<< "$(of "$1")"
    (cd "$package" && CARGO_MANIFEST_DIR=$package nice -n 19 "$program")
}

n_passed() {
    grep -cxF "$1" "$folder/passed" || true
}

for file in "${files[@]}"; do
    [ -n "$(of "$file")" ] || give_up "there is no test file $file in tests/tests"
done

# They keep the cores from the tests, and end with this part.
busy=()
trap 'kill "${busy[@]}"' EXIT
for ((core = 0; core < $(nproc); core++)); do
    nice -n "${BUSY_NICE:-0}" bash -c 'while :; do :; done' &
    busy+=($!)
done

n_failed=0
for ((run = 1; run <= n_runs; run++)); do
    for file in "${files[@]}"; do
        state=$(state_of "$file")
        (($(n_passed "$state") < run)) || continue
        log=$folder/$file-$run.log began=$SECONDS
        if once "$file" > "$log" 2>&1; then
            rm "$log"
            echo "$state" >> "$folder/passed"
            echo "run $run of $file: $(minutes $((SECONDS - began)))"
        else
            echo "run $run of $file failed: $log"
            n_failed=$((n_failed + 1))
        fi
    done
    echo "run $run of $n_runs done, $n_failed failures so far"
done
for file in "${files[@]}"; do
    echo "$file passed $(n_passed "$(state_of "$file")") times"
done
((n_failed == 0))
