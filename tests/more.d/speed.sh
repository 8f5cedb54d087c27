# What a fit costs beside SciPy with Numba, and instructions of steps and fits against those kept (KEEP=1); ten minutes.
needs valgrind valgrind
python=$(tests/python numpy==2.3.5 scipy==1.17.1 numba==0.63.1)
cargo build --release --locked -p host
steps=$(cargo bench --locked -p shared --bench counted --no-run 2>&1 | sed -n 's/.*Executable.*(\(.*\))/\1/p')
rig=$(mktemp --suffix=.toml)
"$BUILT/release/host" init --mass 0.1466084 --length 0.1562177 --inertia 0.00284252 --force -o "$rig"
"$python" tests/speed/table.py "$BUILT/release/host" "$rig"
"$python" tests/speed/counted.py "$steps" "$BUILT/release/host" "$rig"
rm "$rig"
