# Whatever kills, waits, serves a page or runs in QEMU, 20 times at lowest priority while all cores are busy; hours.
# BUSY_RUNS is another number, BUSY_TESTS a choice of test files.
n_runs=${BUSY_RUNS:-20}
read -ra files <<< "${BUSY_TESTS:-$(cd tests/tests && ls -d trust_files* trust_link* link_* page* qemu_* docs* | sed 's/\.rs$//')}"
cargo test --locked -p tests "${files[@]/#/--test=}" --no-run

# They keep the cores from the tests, and end with this part.
busy=()
trap 'kill "${busy[@]}"' EXIT
for ((core = 0; core < $(nproc); core++)); do
    (while :; do :; done) &
    busy+=($!)
done

n_failed=0
for ((run = 1; run <= n_runs; run++)); do
    for file in "${files[@]}"; do
        log=$BUILT/busy-$file-$run.log
        if nice -n 19 cargo test --locked -p tests --test "$file" > "$log" 2>&1; then
            rm "$log"
        else
            echo "run $run of $file failed: $log"
            n_failed=$((n_failed + 1))
        fi
    done
    echo "run $run of $n_runs done, $n_failed failures so far"
done
((n_failed == 0))
