# Can everybody use the page? Every view under axe-core, light and dark, wide and narrow; two minutes.
if command -v npm > /dev/null; then
    npm install --silent --no-save --prefix "$BUILT/axe" axe-core@4.14.1
    AXE=$BUILT/axe/node_modules/axe-core/axe.min.js cargo test --locked --test page axe -- --include-ignored
else
    skip "the page under axe-core" "install npm: apt-get install npm, or brew install node"
fi
