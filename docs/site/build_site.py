#!/usr/bin/env python3
"""The manual as a site that can be searched, with the reference of the headers and a page for each cause.

    build_site.py --abbe build/dev/apps/abbe --reference build/dev/reference/html --out build/dev/site

Pages are those of docs/ in the order of docs/README.md; the table of causes is what the program prints, their pictures
are made with its virtual rig (pictures.py). The theme is Material for MkDocs as Debian has it (mkdocs-material);
nothing is loaded from the network. A link that leads nowhere is an error.
"""
import argparse
import json
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

import pictures

ROOT = pathlib.Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"


def sections():
    """Titles of docs/README.md with the (title, page) of their links; links into a page are left out."""
    for paragraph in DOCS.joinpath("README.md").read_text().split("\n\n"):
        title = re.match(r"\*\*([^*]+)\.\*\*", paragraph)
        if title:
            yield title[1], re.findall(r"\[([^\]]+)\]\(([\w./-]+\.md)\)", paragraph.replace("\n", " "))


def rows(table, cells):
    """Rows of Markdown tables whose first cell is code, as lists of so many cells."""
    for line in table.splitlines():
        row = [each.strip() for each in line.strip().strip("|").split(" | ")]
        if len(row) >= cells and re.fullmatch(r"`[\w-]+`", row[0]):
            yield row


def causes(program):
    """id -> [what it is, what it shows, what to check, keys] of each kind of its objects."""
    table = subprocess.run([program, "causes"], check=True, capture_output=True, text=True).stdout
    known = {}
    for name, *words in rows(table, 5):
        known.setdefault(name.strip("`"), []).append(words)
    return known


def objects():
    """id -> an object, of the effects that the virtual rig hides."""
    text = DOCS.joinpath("virtual-rig.md").read_text()
    return {row[0].strip("`"): re.search(r"`([^`]+)`", row[1])[1] for row in rows(text, 4)}


def page_of(name, kinds, picture):
    what, shows, check, _ = kinds[0]
    keys = "; ".join(dict.fromkeys(kind[3] for kind in kinds if kind[3]))
    text = f"# {name}\n\n{what[0].upper()}{what[1:]}.\n\n**What it shows.** {shows[0].upper()}{shows[1:]}.\n\n"
    text += f"**What to check.** {check[0].upper()}{check[1:]}.\n\n"
    if keys:
        text += f"**Keys.** {keys}\n\n"
    if picture:
        text += (f"![{name}]({name}.svg)\n\n*Readings of a virtual machine with the cause minus those of the same "
                 f"machine without ({picture}).*\n\n")
    else:
        text += "The virtual rig does not make it, so there is no picture.\n\n"
    return text + "[All causes](../causes.md) · [The diagnosis](../diagnose.md)\n"


def write_causes(program, into):
    into.mkdir()
    hides = objects()
    for name, kinds in causes(program).items():
        picture = None
        if name in hides:
            picture = pictures.draw(program, ROOT / "machines/demo_mill.toml", name, hides[name],
                                    into / f"{name}.svg")
        (into / f"{name}.md").write_text(page_of(name, kinds, picture))


def linked(page):
    """A page whose causes, where they stand first in a row of their table, lead to their own."""
    begin, end = page.index("<!-- causes: begin -->"), page.index("<!-- causes: end -->")
    table = re.sub(r"^\| `([\w-]+)` \|", r"| [`\1`](causes/\1.md) |", page[begin:end], flags=re.M)
    return page[:begin] + table + page[end:]


def copy_pages(into):
    """docs/ as it is; what a page names outside of it comes along in project/."""
    into.mkdir(parents=True)
    for file in (*DOCS.glob("*.md"), *DOCS.glob("*.png")):
        shutil.copy(file, into / file.name)
    for file in into.glob("*.md"):
        text = file.read_text()
        for name in set(re.findall(r"\]\(\.\./([\w./-]+)\)", text)):
            (into / "project" / name).parent.mkdir(parents=True, exist_ok=True)
            (into / "project" / name).write_text(ROOT.joinpath(name).read_text().replace("](docs/", "](../"))
            text = text.replace(f"](../{name})", f"](project/{name})")
        file.write_text(linked(text) if file.name == "causes.md" else text)


def menu(pages, has_reference):
    nav = [{"The manual": "README.md"}]
    for title, links in sections():
        nav.append({title: [{name: page} for name, page in links]})
    nav.append({"Each cause": [f"causes/{page.name}" for page in sorted((pages / "causes").glob("*.md"))]})
    if has_reference:
        nav.append({"Headers": "headers.md"})
        (pages / "headers.md").write_text("# Headers\n\n[The reference of the library](reference/index.html), by "
                                          "header, class and function.\n")
    return nav


def build(pages, out, more):
    """What MkDocs says where it refuses the pages; empty: the site is in the folder `out`."""
    site = {"site_name": "abbe", "docs_dir": str(pages), "site_dir": str(out), "use_directory_urls": False,
            "strict": True, "plugins": ["search"],
            "theme": {"name": "material", "font": False, "language": "en",
                      "features": ["navigation.tabs", "navigation.top", "search.highlight"],
                      "palette": [{"media": "(prefers-color-scheme: light)", "scheme": "default"},
                                  {"media": "(prefers-color-scheme: dark)", "scheme": "slate"}]},
            "markdown_extensions": ["tables", "toc", "fenced_code", "attr_list"], **more}
    config = pages.parent / "mkdocs.yml"
    config.write_text(json.dumps(site))
    done = subprocess.run([sys.executable, "-m", "mkdocs", "build", "--clean", "--config-file", config],
                          capture_output=True, text=True, check=False)
    return done.stderr if done.returncode != 0 else ""


def search_in_files(site):
    """Lets pages search that a browser opened as files (search_of_files.js)."""
    search = site / "search"
    shutil.copy(pathlib.Path(__file__).with_name("search_of_files.js"), search)
    index = search.joinpath("search_index.json").read_text()
    search.joinpath("search_index.js").write_text(f"searchIndex = {index};\n")
    for page in site.rglob("*.html"):
        text = page.read_text()
        base = re.search(r'<script src="([^"]*)assets/javascripts/bundle', text)
        if base:
            script = f'<script src="{base[1]}search/search_of_files.js" data-base="{base[1]}"></script>'
            page.write_text(text[:base.start()] + script + text[base.start():])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--abbe", required=True, type=pathlib.Path, help="the program")
    parser.add_argument("--reference", type=pathlib.Path, help="folder of the pages that Doxygen wrote")
    parser.add_argument("--out", required=True, type=pathlib.Path, help="folder of the site")
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        pages = pathlib.Path(folder) / "docs"
        copy_pages(pages)
        write_causes(given.abbe.resolve(), pages / "causes")
        if given.reference:
            shutil.copytree(given.reference, pages / "reference")
        refused = build(pages, given.out.resolve(), {"nav": menu(pages, given.reference is not None)})
    if refused:
        sys.exit(refused)
    search_in_files(given.out)
    print(given.out / "index.html")


if __name__ == "__main__":
    main()
