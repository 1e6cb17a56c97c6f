"""The headers of the project and their comments, for the checks of this folder."""
import re

from arrows import ARROWS, internal


def all_of(root):
    """The headers of all folders of the architecture, as "folder/file.h"."""
    files = (file for folder in ARROWS for file in (root / folder).glob("**/*.h"))
    return sorted(file.relative_to(root).as_posix() for file in files if "node_modules" not in file.parts)


def installed(root):
    """Those that the package installs: not the program's own and not what folders keep to themselves."""
    kept = set(internal(root))
    return [name for name in all_of(root) if name not in kept and not name.startswith(("apps/", "python/", "study/"))]


def comments(text):
    """Yields (line number, text after the slashes) of every line that is a comment or ends with one."""
    for number, line in enumerate(text.split("\n"), 1):
        match = re.match(r'(?:[^"/]|"(?:[^"\\]|\\.)*"|/(?!/))*//(.*)', line)
        if match:
            yield number, match[1]


def paragraphs(text):
    """Yields (line number, lines) of the indented paragraphs of the comments that stand in lines of their own."""
    lines = text.split("\n")
    paragraph = []
    for number, line in enumerate([*lines, ""], 1):
        match = re.match(r"\s*//(   *\S.*)$", line)
        if match and match[1].startswith("   "):
            paragraph.append(match[1])
        elif paragraph:
            yield number - len(paragraph), paragraph
            paragraph = []


def code(text):
    """The text without its comments."""
    return re.sub(r"//[^\n]*|/\*.*?\*/", "", text, flags=re.S)
