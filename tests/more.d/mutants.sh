# Errors made on purpose: the share that the tests catch, by folder of the code, and what survives; hours.
# MUTANTS is the size of each folder's sample (150), MUTANTS_FOLDERS names folders of tests/mutants/folders.json.
needs python3 python3
tools=$BUILT/tools
[ -x "$tools/bin/cargo-mutants" ] || cargo install --locked cargo-mutants --version 27.1.0 --root "$tools"
read -ra folders <<< "${MUTANTS_FOLDERS:-shared noise recording record}"
PATH=$tools/bin:$PATH python3 tests/mutants/mutants.py "${folders[@]}"
