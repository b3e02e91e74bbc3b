"""Numbers of things in words."""


def counted(number: int, noun: str) -> str:
    """A number of things: ``1 step``, ``2 steps``.

    Args:
        number: of them.
        noun: what one of them is called; more are called so with an s.
    """
    return f"{number} {noun}" + "s" * (number != 1)
