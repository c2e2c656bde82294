#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""All pages as a site that can be searched, without a network and without a server: `make site`.

    site.py BUILD OUTPUT       the site, from the pages of the tree and those of BUILD/docs
    site.py --check FOLDER     every link and anchor in it leads somewhere, nothing is loaded from elsewhere

mkdocs makes the pages. The Markdown is the one that stands, in the folders in which it stands, so that links
hold; beside it are the files that it links to. Three things are changed on the way: lists and tables may
follow a paragraph at once, as elsewhere; links to a folder lead to a list of its files; the index of the
search is a script, since a page that was opened as a file may not read others."""
import html.parser
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import urllib.parse

SOURCE = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
LINK = re.compile(r"(\]\()([^)#\s]+)((?:#[^)]*)?\))")
FENCE = re.compile(r"(^```.*?^```[^\n]*$)", re.S | re.M)

SEARCH = """
// The index is in `docs`; lunr is loaded before.
(function () {
  "use strict";
  const texts = new Map(site_index.docs.map((doc) => [doc.location, doc]));
  const index = lunr(function () {
    this.ref("location");
    this.field("title", {boost: 10});
    this.field("text");
    site_index.docs.forEach((doc) => this.add(doc));
  });
  const place = document.getElementById("mkdocs-search-results");
  const input = document.getElementById("mkdocs-search-query");
  function show(words) {
    place.textContent = "";
    const found = index.query((query) => {
      for (const word of lunr.tokenizer(words)) {
        query.term(word, {boost: 5});
        query.term(word, {wildcard: lunr.Query.wildcard.TRAILING});
      }
    });
    if (!found.length) place.textContent = "Nothing found.";
    for (const {ref} of found.slice(0, 40)) {
      const doc = texts.get(ref);
      const link = document.createElement("a");
      link.href = base_url.replace(/[/]*$/, "/") + ref;
      link.textContent = doc.title;
      const head = document.createElement("h3");
      head.append(link);
      const text = document.createElement("p");
      text.textContent = doc.text.slice(0, 200);
      const result = document.createElement("article");
      result.append(head, text);
      place.append(result);
    }
  }
  if (!input || !place) return;
  input.value = new URLSearchParams(location.search).get("q") || input.value;
  input.addEventListener("input", () => show(input.value));
  if (input.value) show(input.value);
})();
"""


def fail(text):
    sys.exit(f"site.py: {text}")


def pages():
    """The Markdown of the tree, and of its build."""
    found = subprocess.run(["git", "ls-files", "-co", "--exclude-standard", "*.md"], cwd=SOURCE, check=True,
                           capture_output=True, text=True).stdout.split()
    return [path for path in found if os.path.exists(os.path.join(SOURCE, path))]


def spaced(text):
    """Lists and tables begin after an empty line."""
    lines, kind = [], ""
    for line in text.split("\n"):
        now = "list" if re.match(r"([-*]|\d+\.) ", line) else "table" if line.startswith("|") else \
            kind if line.startswith(" ") and kind == "list" else "text" if line.strip() else ""
        if now in ("list", "table") and kind not in (now, ""):
            lines.append("")
        lines.append(line)
        kind = now
    return "\n".join(lines)


def link(folder, stage, match):
    """A link as it is on the site; what it leads to is put there."""
    head, target, tail = match.groups()
    if re.match(r"[a-z]+:", target):
        return match.group(0)
    path = os.path.normpath(os.path.join(folder, target))
    source, place = os.path.join(SOURCE, path), os.path.join(stage, path)
    if os.path.isdir(source):
        listing = os.path.join(place, "README.md")
        if not os.path.exists(listing):
            os.makedirs(place, exist_ok=True)
            names = sorted(name for name in os.listdir(source) if not os.path.isdir(os.path.join(source, name)))
            for name in names:
                if not name.endswith(".md"):
                    shutil.copy(os.path.join(source, name), place)
            with open(listing, "w", encoding="utf-8") as file:
                file.write(f"# {path}\n\n" + "".join(f"- [{name}]({name})\n" for name in names))
        target = target.rstrip("/") + "/README.md"
    elif not target.endswith(".md") and os.path.isfile(source):  # what is missing is found by `check`
        os.makedirs(os.path.dirname(place), exist_ok=True)
        shutil.copy(source, place)
    return head + target + tail


def prepare(build, stage):
    """The pages as mkdocs reads them."""
    made = os.path.join(build, "docs")
    files = {path: os.path.join(SOURCE, path) for path in pages()}
    files.update({f"docs/{name}": os.path.join(made, name) for name in os.listdir(made) if name.endswith(".md")})
    for path, source in files.items():
        with open(source, encoding="utf-8") as file:
            parts = FENCE.split(file.read())
        for i in range(0, len(parts), 2):
            parts[i] = LINK.sub(lambda match, at=os.path.dirname(path): link(at, stage, match), spaced(parts[i]))
            if i > 0:
                parts[i] = "\n" + parts[i]
        place = os.path.join(stage, path)
        os.makedirs(os.path.dirname(place), exist_ok=True)
        with open(place, "w", encoding="utf-8") as file:
            file.write("".join(parts))
    if os.path.isdir(os.path.join(stage, "docs", "schema")):
        for name in os.listdir(os.path.join(made, "schema")):
            shutil.copy(os.path.join(made, "schema", name), os.path.join(stage, "docs", "schema"))
        names = sorted(name for name in os.listdir(os.path.join(stage, "docs", "schema")) if name.endswith(".json"))
        with open(os.path.join(stage, "docs", "schema", "README.md"), "w", encoding="utf-8") as file:
            file.write("# JSON Schemas\n\n" + "".join(f"- [{name}]({name})\n" for name in names))
    # The program as a page, where it has been built.
    web = f"{build}-web/starguard.html"
    if os.path.exists(web):
        shutil.copy(web, os.path.join(stage, "try.html"))
        with open(os.path.join(stage, "README.md"), "r+", encoding="utf-8") as file:
            text = file.read().replace("\n\n", "\n\n**[Try it](try.html)** in this browser.\n\n", 1)
            file.seek(0)
            file.write(text)
    return set(files)


def title(stage, path):
    with open(os.path.join(stage, path), encoding="utf-8") as file:
        found = re.search(r"^# (.*)$", file.read(), re.M)
    return re.sub(r"[`*]", "", found.group(1)) if found else os.path.basename(path)


def navigation(stage, files):
    """The sections of docs/README.md, with the pages in their order there; then all others."""
    with open(os.path.join(stage, "docs/README.md"), encoding="utf-8") as file:
        text = file.read()
    contents, seen = [{"starguard": "README.md"}], {"README.md"}
    for part in re.split(r"^## ", text, flags=re.M)[1:]:
        members = []
        for name in re.findall(r"\]\(([\w./-]+\.md)\)", part):
            path = os.path.normpath(os.path.join("docs", name))
            if path in files and path not in seen and os.path.dirname(path) in ("docs", "docs/tutorials"):
                seen.add(path)
                members.append({title(stage, path): path})
        if members:
            contents.append({part.split("\n")[0]: members})
    others = sorted(path for path in files - seen)
    contents.append({"More": [{title(stage, path): path} for path in others]})
    return contents


def make(build, output):
    try:
        import mkdocs.commands.build
        import mkdocs.config
    except ImportError:
        fail("mkdocs is not installed: apt-get install mkdocs, or scripts/install-deps.sh site")
    with open(os.path.join(SOURCE, "include/starguard/version.h"), encoding="utf-8") as file:
        version = ".".join(re.findall(r"STARG_VERSION_[A-Z]+ (\d+)", file.read()))
    with tempfile.TemporaryDirectory() as folder:
        stage = os.path.join(folder, "pages")
        files = prepare(build, stage)
        # A configuration is a file; YAML contains JSON.
        with open(os.path.join(folder, "mkdocs.yml"), "w", encoding="utf-8") as file:
            json.dump({
                "site_name": f"starguard {version}", "docs_dir": stage, "site_dir": os.path.abspath(output),
                "use_directory_urls": False, "nav": navigation(stage, files), "plugins": ["search"],
                "theme": {"name": "readthedocs", "highlightjs": False, "navigation_depth": 2},
                "extra_css": [], "copyright": "Apache License 2.0"}, file)
        config = mkdocs.config.load_config(file.name)
        config["mdx_configs"].setdefault("toc", {})["slugify"] = lambda text, _: anchor(text)
        mkdocs.commands.build.build(config)
    finish(output)


def anchor(text):
    """The name of a heading in links."""
    return re.sub(r"[^\w\- ]", "", text.lower()).replace(" ", "-")


def finish(output):
    """The search works without a server; what only a server needs is left out."""
    search = os.path.join(output, "search")
    with open(os.path.join(search, "search_index.json"), encoding="utf-8") as file:
        docs = json.load(file)["docs"]
    with open(os.path.join(search, "main.js"), "w", encoding="utf-8") as file:
        file.write("const site_index = " + json.dumps({"docs": docs}, ensure_ascii=False) + ";\n" + SEARCH)
    for name in ("404.html", "search/search_index.json", "search/worker.js", "sitemap.xml", "sitemap.xml.gz"):
        if os.path.exists(os.path.join(output, name)):
            os.remove(os.path.join(output, name))
    # Debian's theme has its jQuery under another name than its pages say, and not what marks up code.
    scripts = os.path.join(output, "js")
    for name in os.listdir(scripts):
        if name.startswith("jquery-"):
            os.rename(os.path.join(scripts, name), os.path.join(scripts, "jquery.js"))
    for path in html_files(output):
        with open(path, encoding="utf-8") as file:
            text = file.read()
        text = re.sub(r"js/jquery-[\d.]+\.min\.js", "js/jquery.js", text)
        text = re.sub(r"<!--\[if lt IE 9\]>.*?<!\[endif\]-->", "", text, flags=re.S)
        if not os.path.exists(os.path.join(scripts, "theme_extra.js")):
            text = re.sub(r'<script src="[^"]*js/theme_extra\.js"[^>]*></script>', "", text)
        text = text.replace("<table>", '<table class="docutils">')
        text = re.sub(r'((?:id="|href="#)[\w-]*)_(\d+")', r"\1-\2", text)  # headings that occur again
        text = re.sub(r'(<script[^>]*src="[^"]*)search/main\.js("[^>]*></script>)',
                      r"\1search/lunr.js\2\n      \1search/main.js\2", text)
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)


def html_files(folder):
    return sorted(os.path.join(at, name) for at, _, names in os.walk(folder)
                  for name in names if name.endswith(".html"))


class Page(html.parser.HTMLParser):
    """Anchors, links and what is loaded."""

    def __init__(self, path):
        super().__init__()
        self.names, self.links, self.loaded = set(), [], []
        with open(path, encoding="utf-8") as file:
            self.feed(file.read())

    def handle_starttag(self, tag, attrs):
        values = dict(attrs)
        self.names.update(values[key] for key in ("id", "name") if values.get(key))
        if tag == "a" and values.get("href"):
            self.links.append(values["href"])
        if tag != "a":
            self.loaded += [values[key] for key in ("src", "href") if values.get(key)]


def check(folder):
    """Messages about dead links."""
    # The page of `make web` is a program, not a text.
    parsed = {path: Page(path) for path in html_files(folder) if os.path.basename(path) != "try.html"}
    wrong, count = [], 0
    for path, page in parsed.items():
        where = os.path.relpath(path, folder)
        for target in page.loaded + page.links:
            url = urllib.parse.urlsplit(target)
            if url.scheme == "data":
                continue
            if url.scheme or url.netloc:
                if target in page.loaded:
                    wrong.append(f"{where} loads {target}")
                continue
            count += 1
            place = os.path.normpath(os.path.join(os.path.dirname(path), urllib.parse.unquote(url.path)))
            place = place if url.path else path
            if not os.path.isfile(place):
                wrong.append(f"{where}: {target} does not exist")
            elif url.fragment and place in parsed and url.fragment not in parsed[place].names:
                wrong.append(f"{where}: {target} has no such heading")
    for css in (os.path.join(at, name) for at, _, names in os.walk(folder) for name in names if name.endswith(".css")):
        with open(css, encoding="utf-8") as file:
            wrong += [f"{os.path.relpath(css, folder)} loads {url}"
                      for url in re.findall(r"url\(['\"]?((?:https?:)?//[^)'\"]*)", file.read())]
    return wrong, len(parsed), count


def main(words):
    if len(words) == 2 and words[0] != "--check":
        make(*words)
        folder = words[1]
    elif len(words) == 2:
        folder = words[1]
    else:
        sys.exit(__doc__)
    wrong, count, links = check(folder)
    if wrong:
        fail("\n".join(wrong))
    print(f"site: {folder}/index.html, {count} pages, {links} links lead somewhere")


if __name__ == "__main__":
    main(sys.argv[1:])
