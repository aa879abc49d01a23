"""The explorer as a folder of files that any web server can serve, with the engine in the browser.

A browser keeps the files of one release for times without a network (`web/public/offline.js`).
"""

from __future__ import annotations

import base64
import hashlib
import json
import shutil
from collections.abc import Mapping
from pathlib import Path

from ..model.errors import InputError
from .about import about
from .catalogue import whole
from .server import MISSING, PAGE

_OPENED_AS_A_FILE = (
    "if (location.protocol === 'file:') document.addEventListener('DOMContentLoaded', () => { "
    "document.querySelector('#app').textContent = 'A browser opens a living cell only from a web server: "
    "run python -m http.server in this folder, then open 127.0.0.1:8000 in the browser.'; });"
)
"""A script for a page that is opened from the disk, where browsers load no others."""
_DIGEST = base64.b64encode(hashlib.sha256(_OPENED_AS_A_FILE.encode()).digest()).decode()
POLICY = (
    f"default-src 'self'; script-src 'self' 'sha256-{_DIGEST}'; style-src 'self' 'unsafe-inline'; "
    "img-src 'self' blob: data:; object-src 'none'; base-uri 'none'; form-action 'none'"
)
"""What the page may load: only files of its own folder, and the script above."""
_HEAD = f"""<meta http-equiv="Content-Security-Policy" content="{POLICY}" />
    <meta name="referrer" content="no-referrer" />
    <meta name="cyclosis-engine" content="browser" />
    <script>{_OPENED_AS_A_FILE}</script>
    """


OFFLINE = "offline.js"
"""The service worker that keeps the files, next to the page."""


def write(folder: str | Path, page: Path = PAGE, scales: Mapping[str, float] | None = None) -> int:
    """Write the files and return how many bytes they are.

    The folder must be new or empty. Addresses in the files are relative, so that it can be served under any
    path. With `scales`, a [scales] table, cells are shown in their units at first. Raises `InputError` for
    another folder, and if the page was not built.
    """
    target = Path(folder)
    if not (page / "index.html").is_file():
        raise InputError("explorer", "no page", "built with its page", MISSING)
    try:
        if target.exists() and (not target.is_dir() or any(target.iterdir())):
            raise InputError("static", str(target), "a folder that is new or empty", "choose another")
        shutil.copytree(page, target, dirs_exist_ok=True)
        index = target / "index.html"
        text = index.read_text(encoding="utf-8")
        # The policy comes before everything that it applies to.
        head = _HEAD + _early(target)
        index.write_text(
            text.replace('<meta charset="utf-8" />', f'<meta charset="utf-8" />\n    {head}'.rstrip())
        )
        (target / "api").mkdir()
        for name, found in (("about", about() | {"scales": scales}), ("engine", whole())):
            (target / "api" / name).write_text(json.dumps(found, separators=(",", ":"), allow_nan=False))
        _list(target)
    except OSError as error:
        reason = error.strerror or str(error)
        raise InputError(
            "static", str(target), "a folder that can be written", f"check the path ({reason})"
        ) from error
    return sum(path.stat().st_size for path in target.rglob("*") if path.is_file())


def _early(target: Path) -> str:
    """Return links that load what the page needs later together with its script: it opens sooner."""
    worker = [path.relative_to(target).as_posix() for path in target.glob("assets/worker-*.js")]
    links = [
        f'<link rel="preload" href="api/{name}" as="fetch" crossorigin />' for name in ("about", "engine")
    ]
    links += [f'<link rel="modulepreload" href="{name}" />' for name in worker]
    return "".join(f"{link}\n    " for link in links)


def _list(target: Path) -> None:
    """Write into the service worker which files it keeps, and a name that changes with any of them."""
    script = target / OFFLINE
    files = sorted(path for path in target.rglob("*") if path.is_file() and path != script)
    names = [path.relative_to(target).as_posix() for path in files]
    text = script.read_text(encoding="utf-8")
    digest = hashlib.sha256(text.encode())
    for name, path in zip(names, files, strict=True):
        digest.update(name.encode() + b"\0" + path.read_bytes())
    # A folder's address is that of its page.
    kept = json.dumps(["./", *names])
    text = text.replace("VERSION = ''", f"VERSION = '{digest.hexdigest()[:16]}'").replace(
        "FILES = []", f"FILES = {kept}"
    )
    script.write_text(text, encoding="utf-8")
