"""Headless Chromium, as Debian packages it: what a page is once its script, and a test's, have run."""

import json
import re
import shutil
import subprocess
from html import unescape

import pytest

CHROMIUM = shutil.which("chromium")
needs_browser = pytest.mark.skipif(
    CHROMIUM is None, reason="no chromium on the PATH (Debian: apt install chromium)"
)

_OPTIONS = (
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--disable-default-apps",
    "--enable-logging=stderr",
)


def chromium(folder, *arguments):
    """Run it with a profile of its own; standard output and what the page's console said."""
    done = subprocess.run(
        [CHROMIUM, *_OPTIONS, f"--user-data-dir={folder / 'profile'}", *map(str, arguments)],
        capture_output=True,
        text=True,
        check=False,
        timeout=180,
    )
    console = [line for line in done.stderr.splitlines() if "CONSOLE" in line]
    return done.stdout, console


def usable_ms(page, folder):
    """Milliseconds from the start of loading a page to its second frame once it is loaded; its elements."""
    text = page.read_text(encoding="utf-8")
    text = re.sub("script-src .*?; base-uri", "script-src 'unsafe-inline'; base-uri", text, count=1)
    script = (
        "<script>addEventListener('load', () => requestAnimationFrame(() => requestAnimationFrame(() => "
        "console.log(`usable ${performance.now()} ${document.getElementsByTagName('*').length}`))))"
        "</script></body>"
    )
    copy = folder / "timed.html"
    copy.write_text(text.replace("</body>", script), encoding="utf-8")
    _, console = chromium(
        folder, "--window-size=1280,900", f"--screenshot={folder / 'timed.png'}", copy.as_uri()
    )
    found = re.search(r"usable ([0-9.]+) ([0-9]+)", " ".join(console))
    assert found, console
    return float(found[1]), int(found[2])


def evaluate(page, script, folder):
    """What a script returns that runs on a copy of a page after the page's own; and the console's lines.

    Only in the copy may it run: the page's own policy lets no script run but its own.
    """
    text = page.read_text(encoding="utf-8")
    text = re.sub("script-src .*?; base-uri", "script-src 'unsafe-inline'; base-uri", text, count=1)
    said = "<pre id='said'></pre>"
    wrapped = (
        f"{said}<script>(async () => {{ let said; try {{ said = await (async () => {{ {script} }})(); }}"
        " catch (error) { said = {error: String(error)}; }"
        " document.getElementById('said').textContent = JSON.stringify(said); })();</script></body>"
    )
    copy = folder / "copy.html"
    copy.write_text(text.replace("</body>", wrapped), encoding="utf-8")
    out, console = chromium(folder, "--virtual-time-budget=4000", "--dump-dom", copy.as_uri())
    found = re.search(r'<pre id="said">(.*?)</pre>', out, re.DOTALL)
    assert found, out[-2000:]
    answer = json.loads(unescape(found[1]))
    assert not (isinstance(answer, dict) and "error" in answer), answer
    return answer, console
