"""Links of pages to files of the repository outside docs/ that have another place on the site.

The README is the front page, and READMEs of verification problems are pages of their own. All other
files that a page links can be downloaded from it: MyST sees to that.
"""

import posixpath
import re

LINK = re.compile(r"(\]\()((?:\.\./)+[^)#\s]*)((?:#[^)]*)?\))")
PLACES = (
    (re.compile(r"README\.md"), "docs/index.md"),
    (re.compile(r"src/cdem/verification/(\w+)/README\.md"), r"docs/problems/\1.md"),
)


def redirect(text, folder, page_folder=None):
    """A Markdown text with those links changed.

    Args:
        text: The page.
        folder: Its folder from the root of the repository, to which links are relative.
        page_folder: Folder of its page, if that is another one; all its links are changed then.
    """

    def target(match):
        path = posixpath.normpath(posixpath.join(folder, match[2]))
        for place, page in PLACES:
            path = there.expand(page) if (there := place.fullmatch(path)) else path
        return f"{match[1]}{posixpath.relpath(path, page_folder or folder)}{match[3]}"

    return LINK.sub(target, text)


def _read(app, name, source):
    source[0] = redirect(source[0], posixpath.dirname(f"docs/{name}"))


def setup(app):
    """Called by Sphinx."""
    app.connect("source-read", _read)
    return {"parallel_read_safe": True}
