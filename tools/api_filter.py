#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: MIT
"""Prints a header as the reference of the C++ interface shows it (INPUT_FILTER of docs/Doxyfile).

    tools/api_filter.py HEADER      the header, line by line, with
      - the members of a configuration struct described as its `fields_of` describes them to users: meaning, unit and
        range, which are written once, in the same folder of src/adit; members with a comment keep that;
      - defaulted comparisons left out: they need no sentence.
    tools/api_filter.py --self-test

Lines keep their numbers, so that warnings of Doxygen point to the header.
"""
import re
import sys
from pathlib import Path

TOKEN = re.compile(r"""
    (?P<skip>\s+|//[^\n]*|/\*.*?\*/)
  | (?P<text>"(?:[^"\\\n]|\\.)*")
  | (?P<char>'(?:[^'\\\n]|\\.)+')
  | (?P<number>\.?\d(?:[eEpP][+-]|'(?=\w)|[\w.])*)
  | (?P<name>[A-Za-z_]\w*)
  | (?P<mark>::|->|.)
""", re.VERBOSE | re.DOTALL)
OPENING = {"(": ")", "{": "}", "[": "]"}
COMPARISON = re.compile(r"^[^/\n;{}]*\boperator\s*(?:==|!=|<=>|<=|>=|<|>)\s*\([^;{}]*\)[^;{}]*=\s*default\s*;[^\n]*",
                        re.MULTILINE)
WITHOUT_PREFIX = "Its keys are among those of this struct, without a prefix"


class Token:
    def __init__(self, kind, text, line):
        self.kind, self.text, self.line = kind, text, line


def tokens_of(source):
    tokens, line = [], 1
    for match in TOKEN.finditer(source):
        if match.lastgroup != "skip":
            tokens.append(Token(match.lastgroup, match.group(), line))
        line += match.group().count("\n")
    return tokens


def closing(tokens, start):
    """The index of the bracket that closes the one at `start`, or the end."""
    depth = 0
    for i in range(start, len(tokens)):
        if tokens[i].kind == "mark" and tokens[i].text in OPENING:
            depth += 1
        elif tokens[i].kind == "mark" and tokens[i].text in OPENING.values():
            depth -= 1
            if depth == 0:
                return i
    return len(tokens)


def arguments(tokens, start):
    """What stands between the bracket at `start` and its end, split at commas of that level."""
    end, parts, i = closing(tokens, start), [[]], start + 1
    while i < end:
        if tokens[i].text in OPENING and tokens[i].kind == "mark":
            inner = min(closing(tokens, i), end - 1)
            parts[-1] += tokens[i:inner + 1]
            i = inner
        elif tokens[i].kind == "mark" and tokens[i].text == ",":
            parts.append([])
        else:
            parts[-1].append(tokens[i])
        i += 1
    return parts


def text_of(part):
    """The text of adjacent literals, or None for anything else."""
    if not part or any(token.kind != "text" for token in part):
        return None
    return re.sub(r"\\(.)", r"\1", "".join(token.text[1:-1] for token in part))


def member_of(part, owner):
    """"a.b" of `owner.a.b` or `&owner.a.b`."""
    texts = [token.text for token in part if token.text != "&"]
    return "".join(texts[2:]) if len(texts) > 2 and texts[:2] == [owner, "."] else None


def number_of(part):
    """A number as it is written, without a fraction of nothing: "0.0" is "0"; None for what is no number."""
    text = "".join(token.text for token in part)
    return re.sub(r"\.0*$", "", text) if re.fullmatch(r"-?[\d.]+([eE][+-]?\d+)?", text) else None


def describe(unit, least, most, meaning):
    ranges = [] if None in (least, most) or float(least) == float(most) == 0 else [f"[{least}, {most}]"]
    return "; ".join([meaning.rstrip(",")] + ([unit] if unit else []) + ranges)


def field_from(parts):
    """Key and description of `{"key", &member, "unit", least, most, "meaning", ...}`, or None."""
    if len(parts) < 6 or text_of(parts[0]) is None or text_of(parts[5]) is None:
        return None
    description = describe(text_of(parts[2]) or "", number_of(parts[3]), number_of(parts[4]), text_of(parts[5]))
    choices = [text_of(part) for part in arguments(parts[6], 0)] if len(parts) > 6 and parts[6] else []
    if choices and None not in choices:
        description += "; " + ", ".join(f'"{choice}"' for choice in choices)
    return text_of(parts[0]), description


def single_fields(tokens):
    """Functions of one field, as `Field speed_field(double* speed)`: name -> (key, description)."""
    found = {}
    for i in range(len(tokens) - 4):
        if tokens[i].text == "Field" and tokens[i + 1].kind == "name" and tokens[i + 2].text == "(":
            opening = closing(tokens, i + 2) + 1
            if opening < len(tokens) and tokens[opening].text == "{":
                body = tokens[opening:closing(tokens, opening)]
                for k in range(1, len(body)):
                    field = field_from(arguments(body, k)) if body[k].text == "{" else None
                    if field:
                        found[tokens[i + 1].text] = field
    return found


def fields_in(body, owner, singles):
    """What the body of a function of fields says of the members of `owner`: member -> description."""
    found = {}

    def add(part, key, description):
        member = member_of(part, owner)
        if member is None:
            return
        name = member.partition(".")[0]
        if key != member:
            description = f"`{key}`: {description}"
        found[name] = f"{found[name]}. {description}" if name in found else description

    for i, token in enumerate(body):
        before = body[i - 1].text
        if token.text == "{":
            parts = arguments(body, i)
            field = field_from(parts)
            if field:
                add(parts[1], *field)
        elif token.text == "(" and body[i - 1].kind == "name":
            parts = arguments(body, i)
            if before == "enum_field" and len(parts) == 4 and text_of(parts[0]) and text_of(parts[3]):
                add(parts[1], text_of(parts[0]), describe("", None, None, text_of(parts[3])))
            elif before in singles and len(parts) == 1:
                add(parts[0], *singles[before])
            elif before == "append" and len(parts) == 3 and text_of(parts[1]):
                nested = parts[2]
                while len(nested) > 1 and nested[1].text == "::":
                    nested = nested[2:]
                if nested and nested[0].text == "fields_of" and member_of(nested[2:-1], owner):
                    found.setdefault(member_of(nested[2:-1], owner), f'Keys begin with "{text_of(parts[1])}."')
            elif before == "fields_of" and len(parts) == 1 and member_of(parts[0], owner):
                found.setdefault(member_of(parts[0], owner), WITHOUT_PREFIX)
    return found


def described_members(sources):
    """struct -> member -> description, from the functions `Fields f(Struct& c) {...}` of some sources."""
    structs, all_tokens = {}, [tokens_of(source) for source in sources]
    singles = {}
    for tokens in all_tokens:
        singles.update(single_fields(tokens))
    for tokens in all_tokens:
        for i in range(len(tokens) - 7):
            texts = [token.text for token in tokens[i:i + 8]]
            if texts[0] == "Fields" and texts[2] == "(" and texts[4] == "&" and texts[6:8] == [")", "{"]:
                body = tokens[i + 7:closing(tokens, i + 7)]
                structs.setdefault(texts[3], {}).update(fields_in(body, texts[5], singles))
    return structs


def has_comment(lines, first, last):
    """Whether the declaration on those lines (from 1) has a description of its own."""
    if any("///<" in line for line in lines[first - 1:last]):
        return True
    if last < len(lines) and lines[last].lstrip().startswith("///<"):
        return True
    above = first - 2
    while above >= 0 and not lines[above].strip():
        above -= 1
    return above >= 0 and re.match(r"\s*///(?!<|@)", lines[above]) is not None


def in_group(lines, line):
    """Whether the line (from 1) is within `///@{` and `///@}`, whose description each member gets."""
    for above in reversed(lines[:line - 1]):
        if "///@" in above:
            return "{" in above
    return False


def members_of(tokens, start):
    """(name, type, first line, last line) of the data members of the struct whose brace is at `start`."""
    i, end, members = start + 1, closing(tokens, start), []
    while i < end:
        begin, name, is_function, is_member = i, None, False, True
        if tokens[i].text in ("public", "private", "protected") and tokens[i + 1].text == ":":
            i += 2
            continue
        if tokens[i].text in ("using", "friend", "static", "enum", "struct", "class", "template", "union"):
            is_member = False
        while i < end and tokens[i].text != ";":
            text = tokens[i].text
            if text in ("=", "{") and name is None:
                name = i - 1
            if text == "(" and name is None:
                is_function = True
            if text in OPENING:
                i = closing(tokens, i)
                if text == "{" and is_function:
                    break
            i += 1
        at = name if name is not None else i - 1
        if is_member and not is_function and i < end and tokens[at].kind == "name":
            members.append((tokens[at].text, tokens[begin].text, tokens[begin].line, tokens[i].line))
        i += 1
    return members


def comment(description, member_type):
    """The description as a comment that has no meaning to Doxygen but for its backticks."""
    if member_type == "bool":
        description = description.removesuffix("; [0, 1]")
    return "  ///< " + re.sub(r"([\\@&$#<>%])", r"\\\1", description[:1].upper() + description[1:])


def with_descriptions(header, structs):
    lines, tokens = header.split("\n"), tokens_of(header)
    added = {}
    for i in range(len(tokens) - 2):
        if tokens[i].text in ("struct", "class") and tokens[i + 1].text in structs and tokens[i + 2].text == "{":
            described = structs[tokens[i + 1].text]
            for name, member_type, first, last in members_of(tokens, i + 2):
                if name in described and not has_comment(lines, first, last) and not in_group(lines, first):
                    added[last] = comment(described[name], member_type)
    for line, text in added.items():
        lines[line - 1] += text
    return "\n".join(lines)


def without_comparisons(header):
    lines = header.split("\n")

    def blank(match):
        first = header.count("\n", 0, match.start()) + 1
        last = first + match.group().count("\n")
        keep = has_comment(lines, first, last) or in_group(lines, first)
        return match.group() if keep else "\n" * match.group().count("\n")

    return COMPARISON.sub(blank, header)


def filtered(header, sources):
    return with_descriptions(without_comparisons(header), described_members(sources))


def functions_of_fields(text):
    """The functions of a source that return fields, each up to a brace in the first column, where clang-format puts the
    one that closes a function of several lines."""
    starts = re.finditer(r"^(?:\[\[nodiscard\]\] )?(?:inline )?Fields? \w+\([^;{}]*\{", text, re.MULTILINE)
    return [text[match.start():text.find("\n}", match.end()) + 2] for match in starts]


def of_file(header):
    """A description before `#pragma once` is of the header; Doxygen would take it for that of what comes next."""
    return re.sub(r"^// SPDX-License-Identifier: .*\n(?=///)", "/// \\\\file\n", header, count=1, flags=re.MULTILINE)


def module_sources(path):
    """The functions of fields in the folder of src/adit that holds a header."""
    parents = list(path.resolve().parents)
    module = next((parents[i - 1] for i in range(1, len(parents)) if parents[i].name == "adit"), parents[0])
    files = sorted(module.rglob("*.cpp")) + sorted(module.rglob("*.hpp"))
    texts = [file.read_text(encoding="utf-8") for file in files if not file.name.endswith("_test.cpp")]
    return [function for text in texts for function in functions_of_fields(text)]


def self_test():
    header = """struct A {
  double rate = 1.0;
  double named = 1.0;  ///< Its own.
  /// Above.
  int above = 0;
  std::string kind =
      {};
  B nested;
  B flat = {};
  C pair;
  Mode mode = Mode::a;
  double extra = 0;
  bool on = true;
  double silent = 0;
  [[nodiscard]] int twice() const { return 2 * above; }
  bool operator==(const A&) const = default;
  /// Of the rate alone.
  bool operator<(const A&) const = default;
};
Fields fields_of(A& c);"""
    source = r"""Field extra_field(double* v) { return {"extra", v, "m", 0, 1e5, "extra"}; }
Fields more(A& c) { return {{"kind", &c.kind, "", 0, 0, "\"kind\"", {"x", "y"}}}; }
Fields fields_of(A& c) {  // {"rate", &c.rate, "", 0, 0, "wrong"}
  Fields fields = fields_of(c.flat);
  fields.push_back({"rate", &c.rate, "1/km", 0.0, 0.5, "share of 10 % "
                    "of rays,"});
  fields.push_back({"on", &c.on, "", 0, 1, "on"});
  fields.push_back({"named", &c.named, "", 0, 1, "other"});
  fields.push_back({"pair_x", &c.pair.x, "m", -1, 1, "first"});
  fields.push_back({"pair_y", &c.pair.y, "m", 1e-3, 1, "second"});
  fields.push_back(enum_field("mode", &c.mode, kModes, "which"));
  fields.push_back(extra_field(&c.extra));
  append(fields, "nested", adit::fields_of(c.nested));
  return fields;
}"""
    expected = header
    for before, after in (
            ("rate = 1.0;", r"rate = 1.0;  ///< Share of 10 \% of rays; 1/km; [0, 0.5]"),
            ("      {};", '      {};  ///< "kind"; "x", "y"'),
            ("B nested;", 'B nested;  ///< Keys begin with "nested."'),
            ("B flat = {};", "B flat = {};  ///< Its keys are among those of this struct, without a prefix"),
            ("C pair;", "C pair;  ///< `pair_x`: first; m; [-1, 1]. `pair_y`: second; m; [1e-3, 1]"),
            ("Mode::a;", "Mode::a;  ///< Which"),
            ("extra = 0;", "extra = 0;  ///< Extra; m; [0, 1e5]"),
            ("on = true;", "on = true;  ///< On"),
            ("  bool operator==(const A&) const = default;", "")):
        expected = expected.replace(before, after, 1)
    result = filtered(header, functions_of_fields(source))
    assert result == expected, result
    assert result.count("\n") == header.count("\n")
    about = of_file("// SPDX-License-Identifier: MIT\n/// What is here.\n#pragma once\n")
    assert about == "/// \\file\n/// What is here.\n#pragma once\n", about
    print("api_filter: self-test passed")


def main():
    if sys.argv[1:] == ["--self-test"]:
        self_test()
        return
    if len(sys.argv) != 2:
        sys.exit("usage: tools/api_filter.py HEADER | --self-test")
    path = Path(sys.argv[1])
    header = path.read_text(encoding="utf-8")
    sources = module_sources(path) if re.search(r"^ *struct ", header, re.MULTILINE) else []
    sys.stdout.reconfigure(encoding="utf-8")
    sys.stdout.write(of_file(filtered(header, sources)))


main()
