#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Manual pages and completion scripts, from the table of commands that `starguard help --json` writes.

Usage: manual.py TABLE.json FOLDER

Files have the places below FOLDER where man and the shells look for them below share/.

Pages are plain man(7), which every man program can show. Dashes, quotes and the like are escaped: otherwise
they are set as typographic characters, which cannot be copied into a shell; a line must not start with a
control character.

A completion script is a table in the shell's own syntax: for every command its options, their values, and its
operands. Values follow from the option's kind: a choice has its words, a text is a file or one of the
lower-case words of its form ("skeleton|medial|FILE"), and numbers have no suggestions."""
import json
import os
import sys

LONGEST = 78
FILES = ("text", "texts")  # kinds of options that take files

# ---- manual pages ----

ESCAPED = str.maketrans({"\\": r"\e", "-": r"\-", "'": r"\(aq", "`": r"\(ga", "^": r"\(ha", "~": r"\(ti"})


def line(text):
    return ("\\&" if text.startswith(".") else "") + text.translate(ESCAPED) + "\n"


def filled(text):
    """Long lines broken between words."""
    out = ""
    while len(text) > LONGEST and (cut := text.rfind(" ", 1, LONGEST + 1)) > 0:
        out += line(text[:cut])
        text = text[cut + 1:]
    return out + line(text)


def paragraphs(text):
    return ".PP\n".join(filled(part) for part in text.split("\n") if part)


def examples(text):
    """Lines that start with '#' describe the ones after them."""
    out, in_command = "", False
    for row in text.splitlines():
        is_command = not row.startswith("#")
        if is_command != in_command:
            out += ".PP\n.RS 4\n.EX\n" if is_command else ".EE\n.RE\n.PP\n"
        in_command = is_command
        out += line(row) if is_command else filled(row[2:])
    return out + (".EE\n.RE\n" if in_command else "")


def page_name(command):
    return "\\-".join(["starguard", *command.split()])


def head(table, name, summary):
    return (f".TH {page_name(name).upper()} 1 \"\" \"starguard {table['program']}\" \"starguard manual\"\n"
            f".SH NAME\n{page_name(name)} \\- {filled(summary)}.SH SYNOPSIS\n")


def option_list(options):
    out = ""
    for o in options:
        letter = f"\\fB\\-{o['letter']}\\fR, " if "letter" in o else ""
        value = f" \\fI{o['value'].translate(ESCAPED)}\\fR" if "value" in o else ""
        out += f".TP\n{letter}\\fB\\-\\-{o['name'].translate(ESCAPED)}\\fR{value}\n{filled(o['help'])}"
    return out


def grouped(table, options):
    """The options by their groups, under titles; those of no group come last."""
    parts = [(g["title"], [o for o in options if o.get("group") == g["name"]]) for g in table["groups"]]
    rest = [o for o in options if "group" not in o]
    return "".join(f".SS {title}\n" + option_list(part) for title, part in parts if part) + option_list(rest)


def command_list(commands):
    return "".join(f".TP\n\\fB{page_name(c['name'])}\\fR(1)\n{filled(c['summary'])}" for c in commands)


def exit_status(table):
    return ".SH EXIT STATUS\n" + "".join(f".TP\n\\fB{e['status']}\\fR\n{filled(e['text'])}"
                                         for e in table["exit_statuses"])


def common_options(table):
    return ".SH COMMON OPTIONS\n" + option_list(table["common_options"])


def program_page(table):
    return (head(table, "", table["summary"]) + "\\fBstarguard\\fR \\fICOMMAND\\fR ... [\\fIoptions\\fR]\n"
            ".SH DESCRIPTION\n" + paragraphs(table["about"]) + ".SH COMMANDS\n" + command_list(members(table, ""))
            + common_options(table) + ".SH MODELS AND FILES\n" + paragraphs(table["files"]) + ".SH EXAMPLES\n"
            + examples(table["first_steps"]) + exit_status(table)
            + ".SH ENVIRONMENT\n.TP\n\\fBNO_COLOR\\fR\nDisables colours if set and not empty.\n")


def command_page(table, c):
    out = (head(table, c["name"], c["summary"]) + f"\\fBstarguard {c['name']}\\fR " + filled(c["usage"])
           + ".SH DESCRIPTION\n" + paragraphs(c["description"]))
    if c["group"]:
        out += ".SH COMMANDS\n" + command_list(members(table, c["name"]))
    if c["options"]:
        out += ".SH OPTIONS\n" + grouped(table, c["options"])
    return (out + common_options(table) + ".SH EXAMPLES\n" + examples(c["examples"]) + exit_status(table)
            + ".SH SEE ALSO\n\\fBstarguard\\fR(1)\n")


# ---- completion ----


def members(table, group):
    """The commands of a group, or ("") of the program."""
    return [c for c in table["commands"] if c["name"].rpartition(" ")[0] == group]


def last_word(command):
    return command["name"].rpartition(" ")[2]


def spaced(words):
    return "".join(" " + word for word in words)


def values(option):
    if option["kind"] in FILES:
        return [word for word in option["value"].split("|") if word[:1].islower()]
    return option.get("choices", [])


def brief(text, special=""):
    """The first sentence, for use in single quotes; `special` are characters with a meaning in the shell's table."""
    out = ""
    for i, c in enumerate(text):
        if c == "\n" or (c in ".;" and text[i + 1:i + 2] in ("", " ")):
            break
        out += "'\\''" if c == "'" else ("\\" if c in special else "") + c
    return out


def names(option):
    return ([f"-{option['letter']}"] if "letter" in option else []) + [f"--{option['name']}"]


def bash(table):
    """A function that examines the words before the cursor."""
    common = table["common_options"]
    top = spaced(last_word(c) for c in members(table, ""))
    out = f"""# bash completion for starguard; made by 'starguard completion bash'
_starguard() {{
    local word=${{COMP_WORDS[COMP_CWORD]}} before=${{COMP_WORDS[COMP_CWORD-1]}}
    local command=${{COMP_WORDS[1]}} options= words= files= options_apply=
    local common="{spaced(name for o in common for name in names(o))}"
    COMPREPLY=()
    if ((COMP_CWORD == 1)); then
        COMPREPLY=($(compgen -W "{top} help --help --version" -- "$word"))
        return
    fi
"""
    for c in table["commands"]:
        if c["group"]:
            out += (f"    if [[ $command == {c['name']} ]] && ((COMP_CWORD > 2)); then\n"
                    f"        command=\"{c['name']} ${{COMP_WORDS[2]}}\"\n    fi\n")
    out += "    case $command in\n"
    for c in table["commands"]:
        out += f"    \"{c['name']}\")\n        options=\"$common"
        out += spaced(name for o in c["options"] for name in names(o)) + "\"\n        case $before in\n"
        for o in c["options"]:
            if o["kind"] != "flag":
                out += (f"            {'|'.join(names(o))}) words=\"{spaced(values(o))}\" "
                        f"files={'yes' if o['kind'] in FILES else ''} ;;\n")
        words = [last_word(m) for m in members(table, c["name"])] if c["group"] else c.get("words", [])
        out += (f"            *) options_apply=yes words=\"{spaced(words)}\" files={'' if words else 'yes'} ;;\n"
                "        esac ;;\n")
    out += f"    help) words=\"{top}\" ;;\n    esac\n    case $before in\n"
    out += "".join(f"        --{o['name']}) return ;;\n" for o in common if o["kind"] != "flag")
    return out + """    esac
    if [[ $options_apply && $word == -* ]]; then
        COMPREPLY=($(compgen -W "$options" -- "$word"))
        return
    fi
    COMPREPLY=($(compgen -W "$words" -- "$word"))
    if [[ $files ]]; then
        local IFS=$'\\n'
        COMPREPLY+=($(compgen -f -- "$word"))
        compopt -o filenames
    fi
}
complete -F _starguard starguard
"""


def zsh_option(o):
    special, out = "[]:\\", ""
    for name in names(o):
        out += f"            '{'*' if o['kind'] in ('points', 'texts') else ''}{name}[{brief(o['help'], special)}]"
        if o["kind"] != "flag":
            out += f":{brief(o['value'], special)}:"
        if o["kind"] == "choice":
            out += f"({spaced(values(o))})"
        elif o["kind"] in FILES:
            out += f"{{_files; compadd --{spaced(values(o))}}}"
        elif o["kind"] != "flag":
            out += " "
        out += "' \\\n"
    return out


def zsh(table):
    """Specifications for _arguments, with the first sentence of each help."""
    def summaries(group):
        return "".join(f"            '{last_word(c)}:{brief(c['summary'])}'\n" for c in members(table, group))

    out = f"""#compdef starguard
# zsh completion for starguard; made by 'starguard completion zsh'
_starguard() {{
    local -a commands
    local command=$words[2]
    if ((CURRENT == 2)); then
        commands=(
{summaries("")}            'help:explain a command'
        )
        _describe command commands
        return
    fi
"""
    for c in table["commands"]:
        if c["group"]:
            out += f"""    if [[ $command == {c['name']} ]]; then
        if ((CURRENT == 3)); then
            commands=(
{summaries(c['name'])}            )
            _describe '{c['name']} command' commands
            return
        fi
        command="{c['name']} $words[3]"
        shift words
        ((CURRENT--))
    fi
"""
    out += "    shift words\n    ((CURRENT--))\n    case $command in\n"
    for c in table["commands"]:
        if not c["group"]:
            out += f"    (\"{c['name']}\")\n        _arguments -S \\\n"
            out += "".join(zsh_option(o) for o in c["options"] + table["common_options"])
            out += "            " + (f"':name:({spaced(c['words'])})'" if "words" in c else "'*:file:_files'") + " ;;\n"
    return out + f"""    (help)
        _arguments ':command:({spaced(last_word(c) for c in members(table, ""))})' ;;
    esac
}}
if [[ $funcstack[1] == _starguard ]]; then
    _starguard "$@"
else
    compdef _starguard starguard
fi
"""


def fish(table):
    """One line per suggestion, with its condition."""
    def begin(words):
        return f"complete -c starguard -n '__starguard_behind {words}'"

    def next_words(words, commands):
        return "".join(begin(f"--next {words}") + f" -f -a {last_word(c)} -d '{brief(c['summary'])}'\n"
                       for c in commands)

    out = """# fish completion for starguard; made by 'starguard completion fish'
# Does the command line, up to the cursor, begin with these words? With --next, and no more?
function __starguard_behind
    set -l typed (commandline -opc)[2..-1]
    if test "$argv[1]" = --next
        set -e argv[1]
        test (count $typed) -eq (count $argv); or return 1
    end
    for i in (seq (count $argv))
        test "$typed[$i]" = $argv[$i]; or return 1
    end
end
"""
    out += next_words("", members(table, "")) + begin("--next") + " -f -a help -d 'explain a command'\n"
    out += next_words("help", members(table, ""))
    for c in table["commands"]:
        if c["group"]:
            out += next_words(c["name"], members(table, c["name"]))
            continue
        for o in c["options"] + table["common_options"]:
            out += begin(c["name"]) + (f" -s {o['letter']}" if "letter" in o else "") + f" -l {o['name']}"
            if o["kind"] != "flag":
                out += f" {'-rF' if o['kind'] in FILES else '-x'} -a '{spaced(values(o))}'"
            out += f" -d '{brief(o['help'])}'\n"
        if "words" in c:
            out += begin(c["name"]) + f" -f -a '{spaced(c['words'])}'\n"
    return out


def main():
    with open(sys.argv[1], encoding="utf-8") as file:
        table = json.load(file)
    texts = {"man/man1/starguard.1": program_page(table), "bash-completion/completions/starguard": bash(table),
             "zsh/site-functions/_starguard": zsh(table), "fish/vendor_completions.d/starguard.fish": fish(table)}
    for c in table["commands"]:
        texts[f"man/man1/starguard-{c['name'].replace(' ', '-')}.1"] = command_page(table, c)
    for name, text in texts.items():
        path = os.path.join(sys.argv[2], name)
        os.makedirs(os.path.dirname(path), exist_ok=True)
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)


if __name__ == "__main__":
    main()
