// Grammar of `.rpi` and `.lus` files for editors. The compiler has a parser of its own (`grammar/rpi.lalrpop`); this one accepts
// both dialects and groups all binary operators from the left, because editors need names and blocks, not precedence.
//
// Words that are keywords in some places only are names elsewhere: the generated lexer accepts a keyword only where the grammar
// does (`word` below).

/** One or more of `rule` with `separator` in between. */
const list = (separator, rule) => seq(rule, repeat(seq(separator, rule)));

/** As `list`, with an optional separator at the end. */
const closed = (separator, rule) => seq(list(separator, rule), optional(separator));

const OPERATORS = [
  "->", "=>", "??", "or", "xor", "and", "=", "<>", "<", "<=", ">", ">=", "+", "-", "*", "/", "%", "div", "mod", "**", "^",
  "fby", "in", "++", "&&", "||", "lsh", "rsh", "when",
];

const CONVERSIONS = [
  "int8", "int16", "int32", "int64", "uint8", "uint16", "uint32", "uint64",
];

module.exports = grammar({
  name: "rpi",

  word: ($) => $.identifier,

  extras: ($) => [/[ \t\r\n\f\ufeff]/, $.doc_comment, $.comment, $.pragma],

  conflicts: ($) => [
    [$.variables, $.concatenation],
    [$.concatenation, $.match_arm],
    [$.concatenation],
    [$._path, $._name],
    [$._contract],
    [$.named_type, $._operand],
    [$.contract_clause, $._operand],
    [$.claim, $._operand],
    [$.var_section],
  ],

  rules: {
    source_file: ($) => repeat($._item),

    _item: ($) =>
      choice(
        $.use,
        $.include,
        $.const_item,
        $.type_item,
        $.datatype,
        $.node,
        $.contract,
        $.fragment,
        $.primitive,
        $.device,
        $.frame,
        $.command,
        $.task,
        $.test
      ),

    use: ($) => seq("use", list(",", field("module", $.identifier)), ";"),
    include: ($) => seq("include", $.string, optional(";")),

    const_item: ($) => seq("const", repeat1(seq($.constant, ";"))),
    constant: ($) =>
      choice(
        seq(list(",", field("name", $.identifier)), ":", $._type, optional(seq("=", $._expression))),
        seq(field("name", $.identifier), "=", $._expression)
      ),

    type_item: ($) => seq("type", repeat1(seq($.type_definition, ";"))),
    type_definition: ($) =>
      seq(field("name", $.identifier), optional($.type_parameters), optional(seq("=", choice($._type, $.enum, $.struct)))),
    enum: ($) => seq("enum", "{", list(",", field("value", $.identifier)), "}"),
    struct: ($) => seq(optional("struct"), "{", closed(choice(";", ","), $.variables), "}"),
    datatype: ($) =>
      seq(
        "datatype", field("name", $.identifier), optional($.type_parameters), "=", optional("|"),
        list("|", $.constructor), ";"
      ),
    constructor: ($) =>
      seq(field("name", $.identifier), optional(seq("(", closed(choice(";", ","), $.variables), ")"))),

    node: ($) =>
      prec.right(
        seq(
          optional(choice("unsafe", "opaque", "transparent")),
          optional("extern"),
          choice("node", "function"),
          optional("imported"),
          field("name", $.identifier),
          optional($.static_parameters),
          choice(
            seq($.ports, "returns", $.ports, optional(choice($._alias, $._c_name, seq(optional(";"), optional($._contract), optional($.body))))),
            $._alias
          ),
          optional(choice(";", "."))
        )
      ),
    contract: ($) =>
      prec.right(
        seq(
          "contract", field("name", $.identifier), optional($.static_parameters), $.ports, "returns", $.ports, optional(";"),
          "let", repeat($.contract_part), "tel", optional(choice(";", "."))
        )
      ),
    _alias: ($) => seq("=", $._callee),
    _c_name: ($) => prec.right(seq("=", field("c_name", $.string), optional(seq(";", optional($._contract))))),

    fragment: ($) =>
      prec.right(
        seq(
          "fragment",
          field("name", $.identifier),
          optional($.static_parameters),
          optional($.ports),
          optional(seq("returns", $.ports)),
          optional(seq("when", field("condition", $._expression), optional("restart"))),
          optional($.budget),
          optional(";"),
          optional($._contract),
          $.body,
          optional(choice(";", "."))
        )
      ),
    budget: ($) => seq("budget", $._expression),

    primitive: ($) =>
      seq(
        "primitive", field("name", $._name), optional($.static_parameters), $.ports, optional(seq("returns", $.ports)),
        optional($.budget), ";"
      ),

    device: ($) => seq("device", field("name", $.identifier), optional($.static_parameters), repeat1($.device_section)),
    device_section: ($) =>
      seq(choice("actuator", "sensor", "status"), repeat1(seq(list("|", $.device_port), ";"))),
    device_port: ($) => seq(list(",", field("name", $.identifier)), ":", choice($._type, $.struct)),

    frame: ($) =>
      seq(
        "frame", list(",", field("name", $.identifier)), optional(seq("in", $._path)),
        optional(seq("=", $._expression)), ";"
      ),

    command: ($) =>
      prec.right(
        seq(
          "command", field("name", $.identifier), optional($.static_parameters), optional($.ports),
          optional(seq("given", $.ports)), optional($.budget), optional(";"), optional($._contract), $.body,
          optional(choice(";", "."))
        )
      ),

    test: ($) => prec.right(seq("test", field("title", $.string), $.body, optional(choice(";", ".")))),

    task: ($) =>
      prec.right(
        seq(
          "task", field("name", $.identifier), optional($.static_parameters), optional($.ports), optional(";"), $.steps,
          optional(choice(";", "."))
        )
      ),
    steps: ($) => seq("let", repeat($._step), "tel"),
    _step: ($) => choice($.run, $.repeat, $.parallel, $.start),
    start: ($) => seq("start", field("step", $.identifier), ";"),
    run: ($) =>
      seq(
        optional(seq(field("label", $.identifier), ":")), $._callee, $.arguments,
        optional(list("|", $.branch)), ";"
      ),
    branch: ($) =>
      seq("on", list(",", field("result", choice($.identifier, "fail", "any"))), "then", field("step", choice($.identifier, "end"))),
    repeat: ($) => prec.right(seq("repeat", optional(seq($._expression, "times")), $.steps, optional(";"))),
    parallel: ($) => prec.right(seq("parallel", repeat1($.steps), optional(";"))),

    static_parameters: ($) => choice(seq("<<", closed(";", $.static_parameter), ">>"), $.type_parameters),
    type_parameters: ($) => seq("<", closed(choice(";", ","), $.identifier), ">"),
    static_parameter: ($) =>
      choice(
        seq("type", field("name", $.identifier), optional(seq(":", choice($.identifier, "real")))),
        seq(optional("const"), $.constant),
        seq(choice("node", "function"), field("name", $.identifier), optional($.static_parameters), $.ports, "returns", $.ports)
      ),

    ports: ($) => seq("(", optional(closed(";", $.variables)), ")"),
    variables: ($) =>
      choice(
        seq(
          optional("const"), list(",", field("name", $.identifier)), ":", $._type, optional(seq("when", $._clock)),
          optional(seq("=", $._expression)), optional(seq("|", $._expression))
        ),
        seq("(", closed(";", $.variables), ")", "when", $._clock)
      ),
    _clock: ($) =>
      choice(
        $.identifier,
        seq("not", choice($.identifier, seq("(", $.identifier, ")"))),
        seq(choice($._name, "true", "false"), "(", $.identifier, ")"),
        seq("(", $._clock, ")")
      ),

    _type: ($) => choice($.array_type, $.optional_type, $._type_atom),
    array_type: ($) => prec.left(2, seq($._type, "^", $._size)),
    _size: ($) => prec.left(3, choice($._operand, seq($._size, choice("+", "-", "*", "/", "div", "mod"), $._operand))),
    optional_type: ($) => prec.left(2, seq($._type, "?")),
    _type_atom: ($) =>
      choice($.basic_type, $.real_type, $.named_type, $.tuple_type, $.subrange, $.refinement),
    basic_type: (_) => choice("bool", "int"),
    real_type: ($) => prec.right(seq("real", optional($.unit))),
    named_type: ($) =>
      prec.right(
        seq(
          field("name", choice($._name, alias(choice(...CONVERSIONS, "sint", "uint"), $.identifier))),
          optional(choice($.static_arguments, $.type_arguments)), optional($.frames)
        )
      ),
    type_arguments: ($) => seq("<", closed(choice(";", ","), choice($._type, $.integer)), ">"),
    frames: ($) => seq("(", $._path, optional(seq("in", $._path)), ")"),
    tuple_type: ($) => seq("[", list(",", $._type), "]"),
    subrange: ($) =>
      seq("subrange", "[", choice($._expression, "*"), ",", choice($._expression, "*"), "]", "of", "int"),
    refinement: ($) => seq("subtype", $.refined),
    refined: ($) => seq("{", $.identifier, ":", $._type, "|", $._expression, "}"),

    unit: ($) => seq(token.immediate("["), $._unit_factors, "]"),
    _unit_factors: ($) =>
      seq(choice($.integer, $.unit_factor), repeat(choice(seq("*", $.unit_factor), seq("/", choice($.unit_factor, seq("(", $._unit_factors, ")")))))),
    unit_factor: ($) => seq(field("unit", choice($.identifier, "%")), optional(seq("^", optional("-"), $.integer))),

    _contract: ($) => seq("con", repeat($.contract_part), "noc", optional(";")),
    contract_part: ($) =>
      choice(
        seq("var", list(",", $.variables), ";"),
        seq("const", $.constant, ";"),
        seq($.contract_clause, ";"),
        seq("import", $._callee, $.arguments, "returns", $.arguments, ";"),
        seq("mode", field("name", $.identifier), "(", repeat(seq($.contract_clause, ";")), ")", ";")
      ),
    contract_clause: ($) => seq(choice("assume", "guarantee", "require", "ensure"), optional($.string), $._expression),

    body: ($) => seq(repeat(choice($.var_section, $.const_item)), "let", repeat($._statement), "tel"),
    var_section: ($) => seq("var", repeat1(seq($.variables, ";"))),

    _statement: ($) =>
      choice(
        $.equation, $.call_statement, $.claim, $.command_end, $.export, alias($.fragment, $.local_fragment), $.automaton,
        $.conditional_block, $.when_block, $.cond_block, $.frame_block
      ),
    equation: ($) =>
      seq(choice(list(",", $.target), seq("(", optional(list(",", $.target)), ")")), "=", field("value", $._expression), ";"),
    target: ($) =>
      seq(field("name", $.identifier), repeat(choice(seq(".", field("member", $.identifier)), seq("[", choice($._expression, $.slice), "]")))),
    call_statement: ($) => seq($.call, ";"),
    claim: ($) =>
      seq(choice("assert", "check"), optional($.string), $._expression, optional(seq("provided", $._expression)), ";"),
    command_end: ($) => seq(choice("finish", "yield", "fail"), field("result", $.identifier), "when", $._expression, ";"),
    export: ($) => seq("export", list(",", $._path), ";"),
    conditional_block: ($) =>
      seq("if", $._expression, "then", repeat($._statement), repeat(seq("elsif", $._expression, "then", repeat($._statement))), optional(seq("else", repeat($._statement))), "fi", optional(";")),
    when_block: ($) =>
      seq("when", $._expression, "then", repeat($._statement), optional(seq("else", repeat($._statement))), "end", optional(";")),
    cond_block: ($) =>
      seq("cond", repeat1(seq("|", $._expression, ":", repeat($._statement))), optional(seq("otherwise", optional(":"), repeat($._statement))), "end", optional(";")),
    frame_block: ($) =>
      seq("frame", "(", list(",", $.identifier), ")", repeat($._statement), "let", repeat($._statement), "tel", optional(";")),

    automaton: ($) => seq("automaton", repeat1($.state), "end", optional(";")),
    state: ($) =>
      prec.right(
        seq(
          optional("initial"), "state", field("name", $.identifier), repeat($.unless), optional($.body), repeat($.until)
        )
      ),
    unless: ($) => seq("unless", list("|", $.transition), ";"),
    until: ($) => seq("until", list("|", $.transition), ";"),
    transition: ($) =>
      seq(choice($._expression, "otherwise"), choice("then", "continue"), field("state", $.identifier)),

    _expression: ($) =>
      choice($.binary_expression, $.concatenation, $.unary_expression, $.if_expression, $.when_expression, $.quantifier, $._operand),
    binary_expression: ($) => prec.left(1, seq($._expression, field("operator", choice(...OPERATORS)), $._expression)),
    // Without a precedence: in a `match`, the operator also separates cases.
    concatenation: ($) => prec.dynamic(-1, seq($._expression, "|", $._expression)),
    unary_expression: ($) =>
      prec.right(
        2,
        seq(
          field("operator", choice("-", "not", "pre", "current", "last", "int", "real", "!", ...CONVERSIONS, seq(choice("sint", "uint"), "@", $.type_arguments))),
          $._expression
        )
      ),
    if_expression: ($) =>
      prec.right(seq(choice("if", "with"), $._expression, "then", $._expression, "else", $._expression)),
    when_expression: ($) => prec.right(seq("when", $._expression, "then", $._expression, "else", $._expression)),
    quantifier: ($) => prec.right(seq(choice("forall", "exists"), $.ports, $._expression)),

    _operand: ($) =>
      choice(
        $._name, $.boolean, $.string, $.number, $.quantity, $.percent, $.member, $.index, $.keyed_update, $.call, $.parenthesized, $.tuple,
        alias(choice("current", "last"), $.identifier), $.array, $.struct_value, $.update, $.merge, $.match, $.boolean_list, $.any_value, $.empty_set, $.ascription,
        $.constructor_test
      ),
    number: ($) => choice($.integer, $.real),
    quantity: ($) => seq(choice($.integer, $.real), $.unit),
    percent: ($) => prec(5, seq(choice($.integer, $.real), token.immediate("%"))),
    member: ($) => prec(6, seq($._operand, ".", field("member", $.identifier))),
    index: ($) => prec(6, seq($._operand, "[", choice($._expression, $.slice, seq($._expression, ":", $._expression)), "]")),
    slice: ($) =>
      seq(choice(seq($._expression, ".."), alias($.integer_range, $.integer)), $._expression, optional(seq("step", $._expression))),
    keyed_update: ($) => prec(6, seq($._operand, "[", closed(";", seq($._expression, ":=", $._expression)), "]")),
    parenthesized: ($) => seq("(", $._expression, ")"),
    tuple: ($) => choice(seq("(", ")"), seq(choice("(", "'("), $._expression, ",", list(",", $._expression), ")")),
    ascription: ($) => seq("(", $._expression, ":", $._type, ")"),
    array: ($) => seq("[", list(",", $._expression), "]"),
    update: ($) => seq("(", $._expression, "with", list(";", seq(repeat1(choice(seq(".", $.identifier), seq("[", choice($._expression, $.slice), "]"))), "=", $._expression)), ")"),
    struct_value: ($) =>
      prec(6, seq(field("type", $._name), optional($.static_arguments), "{", optional(seq($._operand, "with")), optional(closed(";", $.field_value)), "}")),
    field_value: ($) => seq(field("name", $.identifier), "=", $._expression),
    merge: ($) =>
      prec.right(
        seq(
          "merge",
          choice(
            seq($.identifier, repeat1(seq("(", choice($._name, "true", "false"), "->", $._expression, ")"))),
            seq("(", $._expression, ";", $._expression, ";", $._expression, ")")
          )
        )
      ),
    match: ($) => seq("match", $._expression, "with", optional("|"), list("|", $.match_arm), "end"),
    match_arm: ($) => seq($.pattern, ":", $._expression),
    pattern: ($) => prec.right(seq($._name, optional(seq("(", list(",", $.pattern), ")")))),
    boolean_list: ($) => prec(6, seq(choice("#", "nor"), "(", list(",", $._expression), ")")),
    any_value: ($) => seq(choice("any", "choose"), choice($.refined, seq("@", $.type_arguments))),
    constructor_test: ($) => prec(6, seq(field("name", $._name), "?", "(", $._expression, ")")),
    empty_set: ($) => seq("{", "}", "@", $.type_arguments),

    call: ($) =>
      prec(
        6,
        choice(
          seq($._callee, $.arguments),
          seq("(", "activate", choice($._callee, seq("(", "restart", $._callee, "every", $._expression, ")")), "every", $._expression,
            optional(seq("initial", "default", list(",", $._expression))), optional(seq("restart", "every", $._expression)), ")", $.arguments),
          seq("(", "restart", $._callee, "every", $._expression, ")", $.arguments)
        )
      ),
    _callee: ($) => prec.right(6, seq(field("function", $._name), optional(choice($.static_arguments, seq("@", $.type_arguments))))),
    arguments: ($) => seq("(", optional(list(",", choice($.named_argument, $._expression))), ")"),
    named_argument: ($) => seq(field("name", $.identifier), ":", $._expression),
    static_arguments: ($) => seq("<<", closed(choice(";", ","), $.static_argument), ">>"),
    static_argument: ($) =>
      seq(optional(seq(field("name", $.identifier), ":")), optional(choice("type", "node", "function", "const")), choice($._expression, $.basic_type, $.real_type, $.array_type, $.optional_type, $.named_type, $.static_operator)),
    static_operator: (_) => prec(-1, choice("+", "-", "*", "/", "and", "or", "xor", "not", "=>", "=", "<", ">", "<=", ">=", "<>", "div", "mod", "if", "pre", "->", "fby")),

    boolean: (_) => choice("true", "false"),
    _path: ($) => list(".", $.identifier),
    _name: ($) => choice($.identifier, $.path),

    identifier: (_) => /[A-Za-z_][A-Za-z0-9_']*/,
    path: (_) => token(/([A-Za-z_][A-Za-z0-9_']*)?(::[A-Za-z_][A-Za-z0-9_']*)+/),
    integer: (_) => token(choice(/[0-9]+/, /0[xX][0-9a-fA-F]+/)),
    integer_range: (_) => token(/[0-9]+\.\./),
    real: (_) =>
      token(choice(/[0-9]+\.[0-9]*([eE][+-]?[0-9]+)?/, /\.[0-9]+([eE][+-]?[0-9]+)?/, /[0-9]+[eE][+-]?[0-9]+/, /0[xX][0-9a-fA-F]+(\.[0-9a-fA-F]*)?[pP][+-]?[0-9]+/, /0[xX][0-9a-fA-F]+\.[0-9a-fA-F]+/)),
    string: (_) => token(/"([^"\\\n]|\\[^\n])*"/),
    // Of Lustre V6: `%ASSUME:name%`.
    pragma: (_) => token(prec(1, /%[A-Za-z_]+:[^%\n]*%/)),
    doc_comment: (_) => token(prec(1, /--\|[^\n]*/)),
    comment: (_) =>
      token(choice(/--[^\n]*/, /\/\/[^\n]*/, seq("(*", /([^*]|\*+[^*)])*\*+/, ")"), seq("/*", /([^*]|\*+[^*/])*\*+/, "/"))),
  },
});
