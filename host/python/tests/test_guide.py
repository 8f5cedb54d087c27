"""The guide's code runs as it stands there."""

import re

from conftest import WORKSPACE


def test_the_guide(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    text = (WORKSPACE / "docs/python-package.md").read_text(encoding="utf-8")
    blocks = re.findall(r"^```python,package\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)
    assert len(blocks) == 7
    exec(compile("\n".join(blocks), "docs/python-package.md", "exec"), {})
