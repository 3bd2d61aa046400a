"""The controls of a stand-alone page of either meshcat."""

_SCRIPT = """<script>
  // the time slider is what one looks for; the tree of the scene is not
  viewer.gui.open();
  viewer.gui.__folders["Scene"].close();
</script>"""


def with_open_controls(page: str) -> str:
    """The page with its controls open at the time slider, which otherwise hide behind a button."""
    head, end, tail = page.rpartition("</body>")
    return f"{head}{_SCRIPT}{end}{tail}"
