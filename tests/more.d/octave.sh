# The exported MATLAB function goes the model's way in Octave, with every effect; some minutes.
if command -v octave-cli > /dev/null; then
    cargo test --locked -p tests --test export -- --include-ignored the_matlab_function
else
    skip "the exported MATLAB function in Octave" "install octave: apt-get install octave, or brew install octave"
fi
