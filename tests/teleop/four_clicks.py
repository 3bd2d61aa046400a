"""What an operator clicks on the page to have the pipe of the test's scene grasped and cut."""

from typing import Any

HEIGHT = 480
"""Of the pictures [pixels]."""


def says(page: Any, text: str, **named: Any) -> None:
    """Wait until the page tells the operator this."""
    page.wait_for_function(
        "text => document.querySelector('#say').innerText.includes(text)", arg=text, **named
    )


def click_the_pipe(page: Any) -> None:
    """A snapshot; then the pipe, in the edges, the grasp and the cut, in the colours: each in the middle of a row."""
    page.click("#snapshot")
    for picture, v, then in (
        ("edges", 150, "grasp it"),
        ("colour", 180, "cut it"),
        ("colour", 110, "confirm"),
    ):
        page.wait_for_selector(f"#{picture}.wants")
        box = page.locator(f"#{picture}").bounding_box()
        page.mouse.click(box["x"] + box["width"] / 2, box["y"] + v / HEIGHT * box["height"])
        says(page, then)
