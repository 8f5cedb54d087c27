# The notebooks, from top to bottom, beside SciPy and PySINDy; minutes. UPDATE_DOCS=1 keeps what they show.
package=$(tests/python-package)
packages=(numpy==2.3.5 pandas==2.3.3 matplotlib==3.10.8 scipy==1.17.1 pysindy==2.1.0 nbconvert==7.17.2
    ipykernel==7.4.0)
python=$(tests/python "${packages[@]}")
keep=(--output-dir "$(mktemp -d)")
[ -z "${UPDATE_DOCS:-}" ] || keep=(--inplace)
env PYTHONPATH="$package" "$python" -m nbconvert --to notebook --execute "${keep[@]}" docs/notebooks/*.ipynb
