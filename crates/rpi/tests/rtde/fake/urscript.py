"""Translator of a subset of URScript to Python generators.

URScript looks like Python, with `end` in place of indentation. Each function of a program becomes a generator: a builtin
that takes time (`servoj`, `stopj`, `sync`, `sleep`) yields once per cycle of the controller. Statements: `def`, `thread`,
`name = run thread()`, `while`, `if`, `elif`, `else`, `end`, `return`, `break`, `continue`, `local`, `global`, assignments, calls. Lists are copied when
they are assigned, as in URScript. Anything else is an error of the program.
"""

import re

# Builtins that take time.
TIMED = {"servoj", "stopj", "sync", "sleep"}
# Builtins that return at once.
INSTANT = {
    "norm",
    "get_steptime",
    "get_actual_joint_positions",
    "get_actual_joint_speeds",
    "get_target_joint_positions",
    "read_input_integer_register",
    "read_input_float_register",
    "write_output_integer_register",
    "write_output_float_register",
    "textmsg",
    "floor",
    "sqrt",
}
WORDS = {"and", "or", "not", "True", "False"}
NAME = r"[A-Za-z_][A-Za-z_0-9]*"


class ScriptError(Exception):
    """Error of a URScript program."""


def without_comment(line):
    """Returns the line up to a `#` that is not in a string."""
    quoted = False
    for at, letter in enumerate(line):
        quoted ^= letter == '"'
        if letter == "#" and not quoted:
            return line[:at]
    return line


def function_names(lines):
    found = (re.match(rf"(?:def|thread) ({NAME})\(", line) for _, line in lines)
    return {match.group(1) for match in found if match}


class Translator:
    """Translates one program. `names` are the functions that the program defines."""

    def __init__(self, lines):
        self.lines = lines
        self.functions = function_names(lines)
        declared = (re.match(rf"global ({NAME})\s*=", line) for _, line in lines)
        self.globals = {match.group(1) for match in declared if match}
        self.output = []
        # The open blocks: `def`, `while` or `if`, and the names that each `def` knows.
        self.blocks = []
        self.scopes = []

    def error(self, number, message):
        raise ScriptError(f"line {number}: {message}")

    def emit(self, depth, text):
        self.output.append("    " * depth + text)

    def expression(self, number, text):
        """Translates an expression, and checks that all its names are known."""
        strings = re.findall(r'"[^"]*"', text)
        text = re.sub(r'"[^"]*"', '""', text)
        if re.search(r"[^A-Za-z_0-9\s+\-*/%<>=!()\[\],.\"]", text):
            self.error(number, f"unknown letter in `{text}`")
        # Keyword arguments: the name before a single `=`.
        keywords = set(re.findall(rf"({NAME})\s*=(?!=)", text))
        for name in re.findall(rf"(?<![0-9.])\b{NAME}\b", text):
            known = name in WORDS | self.functions | INSTANT | TIMED | self.globals | keywords
            if not known and not any(name in scope for scope in self.scopes):
                self.error(number, f"`{name}` is not defined")
        text = self.calls(text)
        for string in strings:
            text = text.replace('""', repr(string[1:-1]), 1)
        return text

    def calls(self, text):
        """Wraps calls that may take time, from the innermost to the outermost."""
        generators = self.functions | TIMED
        pattern = rf"(?<![A-Za-z_0-9.])({NAME})\("
        result, at = "", 0
        for match in re.finditer(pattern, text):
            if match.start() < at:
                continue
            name = match.group(1)
            if name in WORDS:
                continue
            end = self.closing(text, match.end())
            inner = self.calls(text[match.end() : end])
            call = f"{name}({inner})"
            result += text[at : match.start()]
            result += f"(yield from {call})" if name in generators else call
            at = end + 1
        return result + text[at:]

    @staticmethod
    def closing(text, begin):
        depth = 1
        for at in range(begin, len(text)):
            depth += {"(": 1, ")": -1}.get(text[at], 0)
            if depth == 0:
                return at
        raise ScriptError(f"`{text}` has no closing parenthesis")

    def assignment(self, number, line):
        match = re.match(rf"(?:(local|global)\s+)?({NAME})\s*=(?!=)\s*(.+)$", line)
        if not match:
            return None
        scope, name, value = match.groups()
        thread = re.match(rf"run ({NAME})\(\)$", value)
        if thread and thread.group(1) in self.functions:
            return f"{name} = run({thread.group(1)})"
        value = self.expression(number, value)
        if scope == "local":
            self.scopes[-1].add(name)
        elif scope is None and name not in self.globals:
            self.scopes[-1].add(name)
        return f"{name} = copied({value})"

    def statement(self, number, line):
        """Translates one line."""
        depth = len(self.blocks)
        head = re.match(rf"(?:def|thread) ({NAME})\(([^)]*)\):$", line)
        if head:
            parameters = [word.strip() for word in head.group(2).split(",") if word.strip()]
            self.scopes.append(set(parameters))
            self.blocks.append("def")
            self.emit(depth, f"def {head.group(1)}({', '.join(parameters)}):")
            if self.globals - set(parameters):
                self.emit(depth + 1, f"global {', '.join(sorted(self.globals - set(parameters)))}")
            # A function without a builtin that takes time is a generator as well.
            self.emit(depth + 1, "if False: yield")
            return
        if not self.blocks:
            self.error(number, f"`{line}` is outside of the program")
        block = re.match(r"(while|if|elif)\s*(.+):$", line)
        if block and block.group(1) in ("while", "if"):
            self.emit(depth, f"{block.group(1)} {self.expression(number, block.group(2))}:")
            self.blocks.append(block.group(1))
            self.emit(depth + 1, "step()")
        elif block or line == "else:":
            if self.blocks[-1] != "if":
                self.error(number, "`else` without `if`")
            text = f"elif {self.expression(number, block.group(2))}:" if block else "else:"
            self.emit(depth - 1, text)
            self.emit(depth, "step()")
        elif line == "end":
            if self.blocks.pop() == "def":
                self.scopes.pop()
        elif line in ("break", "continue"):
            self.emit(depth, line)
        elif line.startswith("return"):
            self.emit(depth, f"return {self.expression(number, line[6:])}")
        else:
            text = self.assignment(number, line)
            self.emit(depth, text or self.expression(number, line))

    def translate(self):
        for number, line in self.lines:
            self.statement(number, line)
        if self.blocks:
            raise ScriptError(f"{len(self.blocks)} `end` missing")
        return "\n".join(self.output) + "\n"


def translate(text):
    """Returns the name of the program and its Python source."""
    numbered = ((number, without_comment(line).strip()) for number, line in enumerate(text.split("\n"), 1))
    lines = [(number, line) for number, line in numbered if line]
    match = re.match(rf"def ({NAME})\(\):$", lines[0][1]) if lines else None
    if not match:
        raise ScriptError("a program begins with `def name():`")
    return match.group(1), Translator(lines).translate()


def is_complete(text):
    """True if the text has an `end` for each block, so that the controller starts it."""
    depth, begun = 0, False
    for line in text.split("\n")[:-1]:
        line = without_comment(line).strip()
        if re.match(r"(def|thread|while|if)\b.*:$", line):
            depth, begun = depth + 1, True
        elif line == "end":
            depth -= 1
    return begun and depth == 0


class Program:
    """A running program: a generator that is resumed once per cycle of the controller."""

    # A program that loops without a builtin that takes time ends with an error, as on a real controller.
    MOST_STEPS = 20_000

    def __init__(self, text, builtins):
        self.name, source = translate(text)
        self.steps = 0
        self.threads = []
        self.is_in_thread = False
        copied = lambda value: list(value) if isinstance(value, list) else value
        scope = dict(builtins, step=self.step, run=self.run, copied=copied)
        scope["__builtins__"] = {}
        exec(compile(source, self.name, "exec"), scope)
        self.generator = scope[self.name]()

    def run(self, function):
        self.threads.append(function())
        return len(self.threads)

    def step(self):
        self.steps += 1
        if self.steps > self.MOST_STEPS:
            raise ScriptError("infinite loop detected")

    def resume(self):
        """Runs the program for one cycle. Returns false after its end."""
        self.steps = 0
        self.is_in_thread = True
        for thread in self.threads:
            next(thread)
        self.is_in_thread = False
        try:
            next(self.generator)
        except StopIteration:
            return False
        return True
