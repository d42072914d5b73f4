//! The table of diagnostic codes.
//!
//! One row declares a code, its severity and its title. The explanation page is `pages/<code>.md`; a row without a page
//! does not compile. Codes are never renumbered. The first digit is the group: 0 syntax, 1 names, 2 types and units, 3
//! presence and activation, 4 causality, 5 initialisation, 6 resources and takeover, 7 budgets, 8 tasks, 9 run time.

use std::fmt;

/// Severity of a diagnostic. A program with an error is not compiled; warnings and notes do not prevent the
/// compilation.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, PartialOrd, Ord)]
pub enum Severity {
    /// The program is rejected.
    Error,
    /// The program is accepted but probably contains a mistake.
    Warning,
    /// Information that needs no action.
    Note,
}

impl Severity {
    /// Returns the name of the severity in messages: `error`, `warning` or `note`.
    pub const fn as_str(self) -> &'static str {
        match self {
            Severity::Error => "error",
            Severity::Warning => "warning",
            Severity::Note => "note",
        }
    }
}

/// Group of diagnostic codes: the stage or the subject of the check that reports them.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, PartialOrd, Ord)]
pub enum CodeGroup {
    /// Diagnostics of the lexer and the parser.
    Syntax,
    /// Diagnostics about names and declarations.
    Names,
    /// Diagnostics about types and units.
    Types,
    /// Diagnostics about presence (whether a flow has a value in a cycle) and activation of fragments.
    Presence,
    /// Diagnostics about causality: flows that depend on one another in the same cycle.
    Causality,
    /// Diagnostics about initialisation: delays that are read before they have a value.
    Initialisation,
    /// Diagnostics about actuators written twice, and about takeover by a successor.
    Resources,
    /// Diagnostics about budgets: bounds of work, memory and time of a cycle.
    Budgets,
    /// Diagnostics about tasks, the programs of commands.
    Tasks,
    /// Diagnostics reported while programs run, and by the tools themselves.
    RunTime,
}

macro_rules! codes {
    ($($code:ident $severity:ident $title:literal;)*) => {
        /// Diagnostic code: `RPI` and four digits. Each variant is documented by its title.
        #[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, PartialOrd, Ord)]
        #[allow(clippy::upper_case_acronyms)]
        pub enum Code {
            $(#[doc = $title] $code,)*
        }

        impl Code {
            /// All codes in ascending order.
            pub const ALL: &[Code] = &[$(Code::$code,)*];
        }

        const TABLE: &[Row] = &[$(Row {
            code: Code::$code,
            name: stringify!($code),
            severity: Severity::$severity,
            title: $title,
            page: include_str!(concat!("../pages/", stringify!($code), ".md")),
        },)*];
    };
}

struct Row {
    code: Code,
    name: &'static str,
    severity: Severity,
    title: &'static str,
    page: &'static str,
}

codes! {
    RPI0001 Error "unexpected token";
    RPI0002 Error "unknown character";
    RPI0003 Error "unterminated comment";
    RPI0004 Error "unclosed block or bracket";
    RPI0005 Error "unterminated string";
    RPI0006 Error "missing `;`";
    RPI0007 Error "invalid suffix on a number";
    RPI0008 Error "number out of range";
    RPI0009 Error "chained comparison";
    RPI0010 Error "expected a declaration";
    RPI0011 Error "file too large or nested too deeply";
    RPI0012 Error "reserved word used as a name";
    RPI0013 Warning "foreign comment marker";
    RPI0014 Note "contract or property in a comment";
    RPI0015 Warning "`when` parsed as in Lustre V6";
    RPI0016 Error "foreign syntax";
    RPI0017 Error "unsupported Kind 2 construct";
    RPI0018 Warning "ambiguous sign before a power";
    RPI0101 Error "unexpected token in a net";
    RPI0102 Error "unterminated string in a net";
    RPI0103 Error "net nested too deeply";
    RPI1001 Error "undefined name";
    RPI1002 Error "duplicate declaration";
    RPI1003 Error "wrong kind of name";
    RPI1004 Error "unknown member";
    RPI1005 Error "module or file not found";
    RPI1007 Error "cyclic declaration";
    RPI1008 Error "flow defined twice";
    RPI1009 Error "flow is never defined";
    RPI1010 Error "argument mismatch";
    RPI1011 Error "infinite recursion";
    RPI1012 Error "missing external definition";
    RPI1013 Note "unconstrained value";
    RPI1014 Error "missing or misplaced part of a declaration";
    RPI1015 Warning "error in an unused generic node";
    RPI1016 Warning "unused import";
    RPI1017 Warning "unused parameter";
    RPI1018 Error "invalid list of points";
    RPI1019 Warning "unused point";
    RPI1101 Error "unknown primitive";
    RPI1102 Warning "unknown in-port";
    RPI1103 Error "unknown parameter";
    RPI1104 Error "undefined name in a net";
    RPI1105 Error "unknown port";
    RPI1106 Error "conflicting definitions in a net";
    RPI1107 Error "duplicate in-port or parameter";
    RPI1201 Warning "broken link in a doc comment";
    RPI2001 Error "type mismatch";
    RPI2002 Error "dimension mismatch";
    RPI2003 Error "invalid unit";
    RPI2004 Error "angle without a unit";
    RPI2005 Error "frame mismatch";
    RPI2006 Error "invalid operand types";
    RPI2007 Error "cannot infer type";
    RPI2008 Error "constant expression required";
    RPI2009 Error "invalid size or index";
    RPI2010 Error "cannot evaluate constant";
    RPI2011 Error "non-exhaustive match";
    RPI2012 Error "division by zero";
    RPI2013 Error "invalid definition of array elements";
    RPI2014 Error "invalid use of a quantified variable";
    RPI2015 Warning "`div` and `mod` as in Lustre V6";
    RPI2016 Warning "rounded sum of times";
    RPI2017 Error "value out of subrange";
    RPI2018 Error "empty subrange";
    RPI2019 Error "type constraint not satisfied";
    RPI2101 Error "port type mismatch";
    RPI2102 Error "invalid parameter value";
    RPI2103 Error "in-port not connected";
    RPI2104 Error "invalid size or index in a net";
    RPI3001 Error "value may be absent";
    RPI3002 Warning "right side of `??` is never used";
    RPI3004 Error "optional field or element";
    RPI3005 Error "function with state";
    RPI3006 Error "missing or duplicate initial state";
    RPI3007 Error "clock mismatch";
    RPI3008 Warning "stateful operand that can fault";
    RPI3009 Error "ambiguous clock of a delay";
    RPI3101 Warning "unused flow";
    RPI3102 Warning "condition is always false";
    RPI3103 Warning "unreachable state";
    RPI4001 Error "dependency cycle";
    RPI4002 Error "port defined by itself";
    RPI4003 Error "assumption about an output";
    RPI5001 Error "uninitialised `pre`";
    RPI5002 Error "uninitialised `current`";
    RPI5003 Warning "uninitialised `pre` in a property";
    RPI6001 Error "device port used in the wrong direction";
    RPI6002 Error "actuator defined twice";
    RPI6101 Error "conflicting set-points for an actuator";
    RPI6102 Error "command can never finish";
    RPI6103 Warning "unreachable result";
    RPI6104 Note "set-point may be absent";
    RPI6105 Note "mutual exclusion of set-points not proved";
    RPI6201 Warning "missing takeover";
    RPI6202 Warning "command ignores cancel";
    RPI7001 Error "budget exceeded";
    RPI7002 Warning "period exceeded";
    RPI7003 Error "cycle share exceeded";
    RPI8001 Error "misplaced `finish`, `yield` or `fail`";
    RPI8002 Error "unhandled result";
    RPI8003 Warning "duplicate branch for a result";
    RPI8004 Error "missing `given` value";
    RPI8005 Error "device driven by two parallel branches";
    RPI8006 Error "repeat count out of range";
    RPI8007 Warning "unreachable step";
    RPI9001 Error "test assertion failed";
    RPI9002 Error "assertion never evaluated";
    RPI9003 Error "fault during a test";
    RPI9004 Warning "test without an assertion";
    RPI9011 Error "run-time fault";
    RPI9012 Warning "assertion violated";
    RPI9013 Warning "assumption violated";
    RPI9014 Warning "guarantee violated";
    RPI9015 Warning "no contract mode applies";
    RPI9021 Error "invalid recording";
    RPI9102 Warning "not representable in a net";
    RPI9103 Warning "primitive not supported in Lustre";
    RPI9104 Error "external function not linked";
    RPI9201 Error "insecure server address";
    RPI9202 Error "compiler process failed";
    RPI9901 Error "internal compiler error";
}

impl Code {
    /// Returns the name of the code, such as `RPI4001`.
    pub fn as_str(self) -> &'static str {
        self.row().name
    }

    /// Returns the code with this name, such as `RPI4001`, ignoring case; `None` if there is no such code.
    pub fn parse(name: &str) -> Option<Code> {
        TABLE
            .iter()
            .find(|row| row.name.eq_ignore_ascii_case(name))
            .map(|row| row.code)
    }

    /// Returns the title of the code: a short description that all diagnostics of this code share, such as "dependency
    /// cycle".
    pub fn title(self) -> &'static str {
        self.row().title
    }

    /// Returns the group of the code, such as [`CodeGroup::Types`]. The first digit of the code gives the group.
    pub fn group(self) -> CodeGroup {
        match self.as_str().as_bytes().get(3) {
            Some(b'0') => CodeGroup::Syntax,
            Some(b'1') => CodeGroup::Names,
            Some(b'2') => CodeGroup::Types,
            Some(b'3') => CodeGroup::Presence,
            Some(b'4') => CodeGroup::Causality,
            Some(b'5') => CodeGroup::Initialisation,
            Some(b'6') => CodeGroup::Resources,
            Some(b'7') => CodeGroup::Budgets,
            Some(b'8') => CodeGroup::Tasks,
            _ => CodeGroup::RunTime,
        }
    }

    /// Returns true if the code is about the value of a size or a constant. The compiler assumes a value for a
    /// parameter whose value it does not know, so such a diagnostic may be wrong.
    pub fn may_depend_on_values(self) -> bool {
        matches!(
            self,
            Code::RPI1011 | Code::RPI2009 | Code::RPI2010 | Code::RPI2012
        )
    }

    /// Returns whether the code is about a part of the program that this compiler cannot compile, although another tool
    /// may supply or support it.
    pub fn is_external(self) -> bool {
        matches!(self, Code::RPI0017 | Code::RPI1012)
    }

    /// Returns true if the code is about unused or unreachable text, which editors show faded.
    pub fn is_unnecessary(self) -> bool {
        matches!(
            self,
            Code::RPI1016
                | Code::RPI1017
                | Code::RPI1019
                | Code::RPI3002
                | Code::RPI3101
                | Code::RPI3103
                | Code::RPI8007
        )
    }

    /// Returns true if the code is about a missing end of a body or a bracket.
    pub fn is_unclosed(self) -> bool {
        self == Code::RPI0004
    }

    /// Returns the severity of all diagnostics of this code.
    pub fn severity(self) -> Severity {
        self.row().severity
    }

    /// Returns the explanation page in Markdown: the meaning, a wrong and a right program, and how to fix the error.
    pub fn page(self) -> &'static str {
        self.row().page
    }

    fn row(self) -> &'static Row {
        &TABLE[self as usize]
    }
}

impl fmt::Display for Code {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.as_str())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_sorted_and_named_rpi_and_four_digits() {
        assert!(TABLE.windows(2).all(|pair| pair[0].name < pair[1].name));
        for row in TABLE {
            let digits = row.name.strip_prefix("RPI").unwrap_or("");
            assert!(
                digits.len() == 4 && digits.bytes().all(|b| b.is_ascii_digit()),
                "{}",
                row.name
            );
        }
    }

    #[test]
    fn names_read_back() {
        for &code in Code::ALL {
            assert_eq!(Code::parse(code.as_str()), Some(code));
        }
        assert_eq!(Code::parse("rpi0001"), Some(Code::RPI0001));
        assert_eq!(Code::parse("RPI9999999"), None);
    }
}
