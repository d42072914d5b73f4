; Comments and literals
(comment) @comment
(pragma) @attribute
(doc_comment) @comment.documentation
(string) @string
(integer) @number
(real) @number.float
(boolean) @boolean
(unit_factor unit: _ @type.builtin)

; Types
(named_type name: (identifier) @type)
(type_definition name: (identifier) @type.definition)
(device name: (identifier) @type.definition)
(datatype name: (identifier) @type.definition)
(struct_value type: (identifier) @type)
(enum value: (identifier) @constant)

; Declarations
(node name: (identifier) @function)
(contract name: (identifier) @function)
(fragment name: (identifier) @function)
(local_fragment name: (identifier) @module)
(command name: (identifier) @function)
(task name: (identifier) @function)
(primitive name: (_) @function)
(state name: (identifier) @module)
(constant name: (identifier) @constant)
(variables name: (identifier) @variable.parameter)
(device_port name: (identifier) @variable.member)
(frame name: (identifier) @constant)
(use module: (identifier) @module)

; Uses
(call function: (identifier) @function.call)
(call function: (path) @function.call)
(run function: (identifier) @function.call)
(named_argument name: (identifier) @variable.parameter)
(static_argument name: (identifier) @variable.parameter)
(member member: (identifier) @variable.member)
(target member: (identifier) @variable.member)
(field_value name: (identifier) @variable.member)
(command_end result: (identifier) @label)
(branch result: (identifier) @label)
(branch step: (identifier) @label)
(run label: (identifier) @label)
(transition state: (identifier) @module)

; Words
[
  "use" "include" "const" "type" "enum" "struct" "datatype" "node" "function" "contract" "fragment" "primitive" "device"
  "actuator" "sensor" "status" "frame" "command" "given" "task" "test" "var" "budget" "extern" "imported" "unsafe" "opaque"
  "transparent" "returns"
] @keyword
["let" "tel" "con" "noc" "automaton" "state" "initial" "end"] @keyword
[
  "if" "then" "else" "elsif" "fi" "cond" "with" "match" "merge" "unless" "until" "continue" "otherwise" "on" "repeat" "times"
  "parallel" "start"
] @keyword.conditional
["finish" "yield" "fail" "export"] @keyword.return
["assert" "check" "assume" "guarantee" "require" "ensure" "provided" "mode" "import"] @keyword
["pre" "current" "last" "not" "and" "or" "xor" "nor" "div" "mod" "fby" "when" "in" "int"] @keyword.operator
["->" "=>" "??" "=" "<>" "<" "<=" ">" ">=" "+" "-" "*" "/" "%" "**" "^" "|" "++" "&&" "||" "!" "#" "@" ".." ":="] @operator
["(" ")" "[" "]" "{" "}" "<<" ">>"] @punctuation.bracket
["," ";" ":" "."] @punctuation.delimiter

((identifier) @variable.builtin
  (#any-of? @variable.builtin "cancel" "dt" "first" "none" "predecessor" "takeover" "time"))

; After the words: `int` is also an operator, and the last pattern counts.
(basic_type _ @type.builtin)
"real" @type.builtin
