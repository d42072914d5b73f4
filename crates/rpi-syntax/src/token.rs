//! The table of words and signs, and the tokens that logos makes of them.
//!
//! A row of the word table is the only place where a keyword is declared: its spelling, the modes
//! that know it, the place where it is a keyword and not a name, and what it is for. The lexer, the
//! documentation, editors and completion read it.

use crate::Mode;
use crate::name::NameHash;
use logos::Logos;
use std::collections::HashMap;
use std::sync::OnceLock;

/// Where a word is a keyword. Everywhere else it is a name, like any other.
///
/// A contextual word is never a keyword after `.` or before `=`, `:`, `,` or `)`.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Place {
    /// Everywhere: it can not be a name.
    Reserved,
    /// Where a declaration can begin, and directly before a name.
    Declaration,
    /// Where a statement or state can begin, and directly before a name.
    Statement,
    /// Where a name, number or text follows directly, which no name is followed by.
    BeforeName,
    /// Where an operator could stand: after a name, a literal or a closing bracket.
    AfterOperand,
    /// Before a name, or where an operator could stand.
    Either,
    /// Where an operator could stand or a statement could begin.
    Clause,
    /// After `|`, `unless` or `until`.
    Alternative,
    /// Before a name, where an operator could stand or after `|`.
    Branch,
    /// Before a bracket in which variables are declared: `(x: int`, `{ x: int`.
    Binder,
    /// After `(`, before what a conversion converts.
    Conversion,
    /// Before an operand, where none ends; in Lustre everywhere.
    Prefix,
    /// Before a name, before another operand where none ends, and before one in parentheses that cases follow.
    Matched,
}

/// One row of the table of words.
#[derive(Debug)]
pub struct Keyword {
    /// How it is written.
    pub text: &'static str,
    /// Whether `.lus` files know it.
    pub in_lustre: bool,
    /// Whether `.rpi` files know it.
    pub in_rpi: bool,
    /// Where it is a keyword.
    pub place: Place,
    /// What it is for, in a few words.
    pub doc: &'static str,
    /// The token.
    pub(crate) token: Token,
}

impl Keyword {
    /// Whether the word is a keyword in files of this mode.
    pub fn is_in(&self, mode: Mode) -> bool {
        match mode {
            Mode::Rpi => self.in_rpi,
            Mode::Lustre => self.in_lustre,
        }
    }

    /// Whether it can never be a name in files of this mode.
    pub fn is_reserved_in(&self, mode: Mode) -> bool {
        let reserved = match self.place {
            Place::Reserved => true,
            Place::Prefix => mode == Mode::Lustre,
            _ => false,
        };
        self.is_in(mode) && reserved
    }
}

macro_rules! tokens {
    (words { $($word:ident $text:tt $mode:ident $place:ident $doc:literal;)* }
     signs { $($sign:ident $sign_text:tt;)* }) => {
        /// What a stretch of text is.
        #[derive(Logos, Clone, Copy, PartialEq, Eq, Debug)]
        #[logos(skip r"[ \t\r\n\f\u{feff}]+")]
        pub(crate) enum Token {
            $(#[token($text)] $word,)*
            $(#[token($sign_text)] $sign,)*
            #[regex(r"[A-Za-z_][A-Za-z0-9_']*")]
            Ident,
            #[regex(r"[A-Za-z_][A-Za-z0-9_']*(::[A-Za-z_][A-Za-z0-9_']*)+")]
            #[regex(r"::[A-Za-z_][A-Za-z0-9_']*(::[A-Za-z_][A-Za-z0-9_']*)*")]
            Path,
            #[regex(r"[0-9]+")]
            #[regex(r"0[xX][0-9a-fA-F]+")]
            Int,
            /// `0..` of `0..3`, which is no real number; the lexer splits it.
            #[regex(r"[0-9]+\.\.")]
            IntDotDot,
            #[regex(r"([0-9]+\.[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?|[0-9]+[eE][+-]?[0-9]+")]
            #[regex(r"0[xX][0-9a-fA-F]+(\.[0-9a-fA-F]*)?[pP][+-]?[0-9]+")]
            #[regex(r"0[xX][0-9a-fA-F]+\.[0-9a-fA-F]+")]
            Real,
            /// `250mm`: a number that runs into a word; or one of another language, `1.5e-3f`, `1_000.5`, `1'000`.
            #[regex(r"[0-9]+(\.[0-9]*)?([eE][+-][0-9]+)?[A-Za-z_][A-Za-z0-9_]*", priority = 1)]
            #[regex(r"[0-9]+(_[0-9]+)+\.[0-9][0-9_]*", priority = 1)]
            #[regex(r"[0-9]+('[0-9][0-9][0-9])+", priority = 1)]
            NumberWord,
            /// `16#FF`, `T#500ms`: a literal of IEC 61131-3.
            #[regex(r"[0-9]+#[0-9A-Za-z][0-9A-Za-z_]*")]
            #[regex(r"[A-Za-z_][A-Za-z0-9_]*#[+-]?[0-9A-Za-z][0-9A-Za-z_]*([.#][0-9A-Za-z_]+)?")]
            IecLiteral,
            #[regex(r#""([^"\\\n]|\\[^\n])*""#)]
            Str,
            #[regex(r#""([^"\\\n]|\\[^\n])*"#, priority = 1)]
            OpenStr,
            #[regex(r"--[^\n]*", allow_greedy = true)]
            LineComment,
            /// `//`: the lexer says whether a comment begins there.
            #[token("//")]
            SlashComment,
            #[token("(*", |lexer| to_end(lexer, "*)"))]
            #[token("/*", |lexer| to_end(lexer, "*/"))]
            BlockComment,
            /// A block comment without end.
            OpenComment,
            /// A text that names a claim: `assume "sensor range" x < 5.0`.
            Label,
            /// A sign of another language; the lexer puts in ours, see [`crate::habits::SIGNS`].
            #[regex(r"==>?|===|!==?|~=|:=|~")]
            Foreign,
            /// `'(`: a tuple of Kind 2.
            #[token("'(")]
            TickParen,
            /// Marks of [`crate::blocks`]: where a statement of Kind 2 that holds equations begins, goes on and ends.
            IfBlock,
            /// `when c then ... end` as a statement.
            WhenBlock,
            /// `cond | c: ... end`.
            CondBlock,
            /// `frame (x) ... let ... tel`.
            FrameBlock,
            /// `elsif` between the branches of a block.
            ElsIf,
            /// `else` and `otherwise` before the last branch of a block.
            ElseBlock,
            /// `fi`, or `end` of a block or `match`.
            EndBlock,
            /// `|` before an alternative.
            Case,
            /// `?` of `A?(x)`.
            Asks,
            /// `:=` of `a[0 := x]`.
            Becomes,
            /// `--%PROPERTY` of Kind 2.
            Property,
            /// Stands for a phrase with a fault that has been reported.
            Broken,
        }

        /// Every word that is a keyword somewhere, in alphabetic order of its groups.
        pub const KEYWORDS: &[Keyword] = &[$(Keyword {
            text: $text,
            in_lustre: tokens!(@in_lustre $mode),
            in_rpi: tokens!(@in_rpi $mode),
            place: Place::$place,
            doc: $doc,
            token: Token::$word,
        },)*];

        const SIGNS: &[(Token, &str)] = &[$((Token::$sign, $sign_text),)*];
    };
    (@in_lustre Both) => { true };
    (@in_lustre Rpi) => { false };
    (@in_lustre Lustre) => { true };
    (@in_rpi Lustre) => { false };
    (@in_rpi $mode:ident) => { true };
}

/// How the signs of the language are written.
pub fn signs() -> impl Iterator<Item = &'static str> {
    SIGNS.iter().map(|(_, text)| *text)
}

tokens! {
    words {
        And       "and"       Both Reserved     "conjunction";
        Assert    "assert"    Both Reserved     "a condition that holds in every cycle, by the writer's word";
        BoolType  "bool"      Both Reserved     "the type of `true` and `false`";
        Const     "const"     Both Reserved     "declares constants";
        Current   "current"   Both Prefix       "the latest value of a sampled flow";
        Div       "div"       Both Reserved     "integer quotient";
        Else      "else"      Both Reserved     "the value if the condition does not hold";
        Enum      "enum"      Both Reserved     "a type with named values";
        Extern    "extern"    Both Reserved     "a node that is defined outside";
        False     "false"     Both Reserved     "the Boolean that does not hold";
        Fby       "fby"       Both Reserved     "a first value, then a flow one cycle late";
        Function  "function"  Both Reserved     "declares a node without state";
        If        "if"        Both Reserved     "a value by a condition";
        IntType   "int"       Both Reserved     "the type of 64-bit integers; before a real: as an integer";
        Let       "let"       Both Reserved     "begins a body";
        Merge     "merge"     Both Reserved     "joins flows of complementary clocks";
        Mod       "mod"       Both Reserved     "remainder, of integers or reals";
        Node      "node"      Both Reserved     "declares a node";
        Nor       "nor"       Both Reserved     "true if none of several is";
        Not       "not"       Both Reserved     "negation";
        Or        "or"        Both Reserved     "disjunction";
        Pre       "pre"       Both Reserved     "the value at the previous cycle";
        RealType  "real"      Both Reserved     "the type of real numbers; before an integer: as a real";
        Returns   "returns"   Both Reserved     "before the out-ports";
        Struct    "struct"    Both Reserved     "a type with named fields";
        Tel       "tel"       Both Reserved     "ends a body";
        Then      "then"      Both Reserved     "the value if the condition holds; what follows";
        True      "true"      Both Reserved     "the Boolean that holds";
        Type      "type"      Both Reserved     "declares types";
        Unsafe    "unsafe"    Both Reserved     "a node that may have side effects";
        Var       "var"       Both Reserved     "declares local flows";
        When      "when"      Both Reserved     "samples a flow; activates a fragment; ends a command";
        With      "with"      Both Reserved     "a value by a constant condition; changed parts of a value";
        Xor       "xor"       Both Reserved     "exclusive or";

        Activate  "activate"  Both BeforeName   "runs a node when a condition holds";
        Assume    "assume"    Both Statement    "a condition that the caller sees to";
        Check     "check"     Both Statement    "a condition to be shown";
        Con       "con"       Both Clause       "begins a contract";
        Contract  "contract"  Both Declaration  "declares a contract for nodes to import";
        Default   "default"   Both AfterOperand "the value before the first activation";
        Ensure    "ensure"    Both Statement    "what holds in a mode of a contract";
        Every     "every"     Both AfterOperand "before the condition of `activate` and `restart`";
        Guarantee "guarantee" Both Statement    "a condition that the body sees to";
        Import    "import"    Both Statement    "takes up a contract";
        Imported  "imported"  Both BeforeName   "a node that is defined outside";
        Include   "include"   Both BeforeName   "takes up another file";
        Initial   "initial"   Both BeforeName   "the state in which an automaton starts";
        ModeWord  "mode"      Both Statement    "a mode of a contract";
        Noc       "noc"       Both Clause       "ends a contract";
        Of        "of"        Both AfterOperand "before the base of a subrange";
        Require   "require"   Both Statement    "when a contract is in a mode";
        Restart   "restart"   Both Either       "starts afresh";
        Step      "step"      Both AfterOperand "the distance of a slice's elements";

        Command   "command"   Rpi  Declaration  "declares a command";
        Device    "device"    Rpi  Declaration  "declares a device type";
        Fragment  "fragment"  Rpi  Declaration  "declares a fragment, or begins one in place";
        Frame     "frame"     Rpi  Declaration  "declares coordinate frames";
        Primitive "primitive" Rpi  Declaration  "declares a primitive of the control core";
        Task      "task"      Rpi  Declaration  "declares a task";
        Test      "test"      Rpi  Declaration  "declares a test";
        Use       "use"       Rpi  Declaration  "brings in a module";

        Automaton "automaton" Rpi  Statement    "begins a state machine";
        Export    "export"    Rpi  Statement    "makes a flow visible to rules and to the outside";
        Fail      "fail"      Rpi  Statement    "ends a command with an error";
        Finish    "finish"    Rpi  Statement    "ends a command at rest";
        Parallel  "parallel"  Rpi  Statement    "steps of a task beside others, each on devices of its own";
        Repeat    "repeat"    Rpi  Statement    "repeats steps of a task";
        Start     "start"     Rpi  Statement    "names the first step of a task";
        State     "state"     Rpi  Statement    "a state of an automaton";
        Yield     "yield"     Rpi  Statement    "ends a command, maybe in motion, into a successor";

        Actuator  "actuator"  Rpi  BeforeName   "ports that a command writes";
        Last      "last"      Both BeforeName   "the value in the previous cycle, whatever the state";
        Sensor    "sensor"    Rpi  BeforeName   "ports that a command reads";
        Status    "status"    Rpi  BeforeName   "ports about the device itself";

        Budget    "budget"    Rpi  AfterOperand "the time that something may take";
        Continue  "continue"  Rpi  AfterOperand "the next state, resumed where it was left";
        Given     "given"     Rpi  AfterOperand "before the values taken over from the predecessor";
        In        "in"        Both AfterOperand "the frame of the coordinates; whether a set holds a value";
        On        "on"        Rpi  Branch       "what follows a result";
        Times     "times"     Rpi  AfterOperand "after the count of `repeat`";

        End       "end"       Rpi  Clause       "ends an automaton; as a step: the task is done, or its strand";
        Unless    "unless"    Rpi  Clause       "a strong transition";
        Until     "until"     Rpi  Clause       "a weak transition";

        Otherwise "otherwise" Rpi  Alternative  "a transition taken if none before it is";

        AnyOf       "any"         Lustre Binder       "a value that the program leaves open, within a condition";
        Choose      "choose"      Lustre Binder       "a value that only depends on what its condition reads";
        Datatype    "datatype"    Lustre Declaration  "declares a type of alternatives";
        Exists      "exists"      Lustre Binder       "whether a condition holds for some value";
        Forall      "forall"      Lustre Binder       "whether a condition holds for all values";
        Match       "match"       Lustre Matched      "a value by alternatives";
        Opaque      "opaque"      Lustre Declaration  "a node of which callers only know the contract";
        Provided    "provided"    Lustre AfterOperand "when a property has to hold";
        ShiftLeft   "lsh"         Lustre AfterOperand "machine integers: bits moved to the left";
        ShiftRight  "rsh"         Lustre AfterOperand "machine integers: bits moved to the right";
        Subtype     "subtype"     Lustre Binder       "the values of a type for which a condition holds";
        Transparent "transparent" Lustre Declaration  "a node that callers look into";
        Int8        "int8"        Lustre Conversion   "a machine integer";
        Int16       "int16"       Lustre Conversion   "a machine integer";
        Int32       "int32"       Lustre Conversion   "a machine integer";
        Int64       "int64"       Lustre Conversion   "a machine integer";
        UInt8       "uint8"       Lustre Conversion   "a machine integer without sign";
        UInt16      "uint16"      Lustre Conversion   "a machine integer without sign";
        UInt32      "uint32"      Lustre Conversion   "a machine integer without sign";
        UInt64      "uint64"      Lustre Conversion   "a machine integer without sign";
        SInt        "sint"        Lustre Conversion   "a machine integer of so many bits";
        UInt        "uint"        Lustre Conversion   "a machine integer of so many bits, without sign";
    }
    signs {
        Arrow "->"; Implies "=>"; Coalesce "??"; Question "?";
        Le "<="; Ge ">="; Ne "<>"; Lt "<"; Gt ">"; Eq "=";
        LStatic "<<"; RStatic ">>";
        Plus "+"; Minus "-"; Star "*"; Slash "/"; Percent "%"; Pow "**"; Hat "^"; Bar "|";
        Hash "#"; Ampersand "&"; At "@";
        LParen "("; RParen ")"; LBracket "["; RBracket "]"; LBrace "{"; RBrace "}";
        Comma ","; Semi ";"; Colon ":"; Dot "."; DotDot "..";
        BitAnd "&&"; BitOr "||"; BitNot "!"; Append "++";
    }
}

impl Token {
    /// The row of the word table, if the token is a word of it.
    pub(crate) fn keyword(self) -> Option<&'static Keyword> {
        KEYWORDS.get(self as usize)
    }

    /// The word or sign that is always written like this.
    pub(crate) fn of_spelling(text: &str) -> Option<Token> {
        static SPELLED: OnceLock<HashMap<&str, Token, NameHash>> = OnceLock::new();
        let spelled = SPELLED.get_or_init(|| {
            let signs = SIGNS.iter().map(|(token, sign)| (*sign, *token));
            let words = KEYWORDS.iter().map(|word| (word.text, word.token));
            signs.chain(words).collect()
        });
        spelled.get(text).copied()
    }

    /// How the token is always written, if it is.
    pub(crate) fn spelling(self) -> Option<&'static str> {
        let sign = || SIGNS.get(self as usize - KEYWORDS.len());
        match self.keyword() {
            Some(word) => Some(word.text),
            None => sign().map(|(_, text)| *text),
        }
    }
}

/// Whether a text can be a plain name in files of this mode: what importers must see to.
///
/// Contextual words are names too, but a made-up name does well to avoid them: see [`KEYWORDS`].
pub fn is_name(text: &str, mode: Mode) -> bool {
    let mut lexer = Token::lexer(text);
    let whole = lexer.next().is_some_and(|token| {
        let word = token.ok().and_then(Token::keyword);
        token == Ok(Token::Ident) || word.is_some_and(|word| !word.is_reserved_in(mode))
    });
    whole && lexer.span() == (0..text.len())
}

/// Takes in the rest of a block comment.
fn to_end(lexer: &mut logos::Lexer<'_, Token>, end: &str) -> Token {
    match lexer.remainder().find(end) {
        Some(at) => {
            lexer.bump(at + end.len());
            Token::BlockComment
        }
        None => {
            lexer.bump(lexer.remainder().len());
            Token::OpenComment
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_stand_in_the_order_of_the_tokens() {
        for (i, word) in KEYWORDS.iter().enumerate() {
            assert_eq!(word.token as usize, i, "{}", word.text);
            assert_eq!(Token::lexer(word.text).next(), Some(Ok(word.token)));
        }
        for &(token, text) in SIGNS {
            assert_eq!(token.spelling(), Some(text));
            assert_eq!(Token::lexer(text).next(), Some(Ok(token)));
        }
        assert_eq!(Token::Ident.spelling(), None);
    }

    #[test]
    fn names_are_told_from_words_and_signs() {
        for name in ["x", "_", "at_b'", "state", "cancel"] {
            assert!(is_name(name, Mode::Rpi), "{name}");
        }
        for other in ["", "3", "x y", "type", "a.b", "A::b", "-", " x", "x ", "ä"] {
            assert!(!is_name(other, Mode::Rpi), "{other}");
        }
    }

    #[test]
    fn predeclared_names_are_no_words_of_the_table() {
        let predeclared = [
            "cancel",
            "takeover",
            "first",
            "time",
            "dt",
            "predecessor",
            "still",
            "none",
            "present",
            "hold",
        ];
        assert!(
            KEYWORDS
                .iter()
                .all(|word| !predeclared.contains(&word.text))
        );
    }
}
