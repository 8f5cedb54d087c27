# The guide's own effect, added to a copy of the tree: the tests that loop over the list, the documents; 20 minutes.
copy=$(mktemp -d)
trap 'rm -rf "$copy"' EXIT
git ls-files -z --cached --others --exclude-standard | xargs -0 cp --parents -t "$copy"
cd "$copy"
export CARGO_TARGET_DIR=$BUILT

effect=$(sed -n '/^```rust,effect$/,/^```$/{/^```/!p}' docs/add-an-effect.md)
name=$(sed -n 's/^ *name: "\(.*\)",$/\1/p' <<< "$effect")
file=${name//-/_}
echo "$effect" > "shared/src/effect/$file.rs"
sed -i "s/^    torsional_spring,$/&\n    $file,/" shared/src/effect.rs
git diff --no-index --stat "$OLDPWD/shared/src" shared/src || true

cargo run --quiet -p host -- effects --markdown > docs/effects.md
grep -q "$name" docs/effects.md
rustfmt --edition 2024 --check shared/src/effect/*.rs
cargo test -p shared
cargo check -p shared --target "$TARGET"
cargo test -p tests --lib --test physics_effects --test physics_sensitivities --test export --test trust_numbers \
    --test discover --test discover_many --test docs
