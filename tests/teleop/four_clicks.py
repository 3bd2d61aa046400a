"""What an operator clicks on the page to have the pipe of the test's scene grasped and cut."""

from typing import Any

WIDTH, HEIGHT = 640, 480
"""Of the pictures [pixels]."""


def says(page: Any, text: str, **named: Any) -> None:
    """Wait until the page tells the operator this."""
    page.wait_for_function(
        "text => document.querySelector('#say').innerText.includes(text)", arg=text, **named
    )


def click_picture(page: Any, picture: str, u: float, v: float) -> None:
    """Click a pixel, once a click is wanted, wherever the page has been scrolled to."""
    box = page.wait_for_selector(f"#{picture}.wants").bounding_box()
    at = {"x": (u + 0.5) / WIDTH * box["width"], "y": (v + 0.5) / HEIGHT * box["height"]}
    page.click(f"#{picture}", position=at)


def click_the_pipe(page: Any) -> None:
    """A snapshot; then the pipe, in the edges, the grasp and the cut, in the colours: each in the middle of a row."""
    page.click("#snapshot")
    for picture, v, then in (
        ("edges", 150, "grasp it"),
        ("colour", 180, "cut it"),
        ("colour", 110, "confirm"),
    ):
        click_picture(page, picture, WIDTH / 2, v)
        says(page, then)
