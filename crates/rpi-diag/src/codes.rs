//! The table of codes: the only place where a finding is declared.
//!
//! One row is a code, its severity and its title; its page is `pages/<code>.md`, and a row without a
//! page does not compile. Codes are never renumbered. The first digit is the group:
//! 0 syntax, 1 names, 2 types and units, 3 presence and activation, 4 causality, 5 initialisation,
//! 6 resources and takeover, 7 budgets, 8 tasks, 9 run time.

use std::fmt;

/// How much a finding weighs.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, PartialOrd, Ord)]
pub enum Severity {
    /// The program is not accepted.
    Error,
    /// The program is accepted, and the writer should look at it.
    Warning,
    /// Something worth knowing.
    Note,
}

impl Severity {
    /// `error`, `warning` or `note`.
    pub const fn as_str(self) -> &'static str {
        match self {
            Severity::Error => "error",
            Severity::Warning => "warning",
            Severity::Note => "note",
        }
    }
}

macro_rules! codes {
    ($($code:ident $severity:ident $title:literal;)*) => {
        /// What kind of finding it is.
        #[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, PartialOrd, Ord)]
        #[allow(clippy::upper_case_acronyms)]
        pub enum Code {
            $(#[doc = $title] $code,)*
        }

        impl Code {
            /// Every code, in ascending order.
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
    RPI0001 Error "unexpected word or sign";
    RPI0002 Error "unknown character";
    RPI0003 Error "comment without end";
    RPI0004 Error "block without end";
    RPI0005 Error "text without end";
    RPI0006 Error "missing `;`";
    RPI0007 Error "number runs into a word";
    RPI0008 Error "number out of range";
    RPI0009 Error "comparisons in a row";
    RPI0010 Error "outside of any declaration";
    RPI0011 Error "too large or too deeply nested";
    RPI0012 Error "word of the language as a name";
    RPI0013 Warning "foreign comment mark";
    RPI0014 Note "contract or property in a comment";
    RPI0015 Warning "`when` read as in Lustre V6";
    RPI0016 Error "spelling of another language";
    RPI0017 Error "construct of Kind 2 that is not run";
    RPI0018 Warning "sign before a power";
    RPI0101 Error "unexpected sign in a net";
    RPI0102 Error "text without end in a net";
    RPI0103 Error "net nested too deeply";
    RPI1001 Error "name that nothing declares";
    RPI1002 Error "name declared twice";
    RPI1003 Error "name of another kind of thing";
    RPI1004 Error "part that is not there";
    RPI1005 Error "module or file that is not there";
    RPI1007 Error "declaration that needs itself";
    RPI1008 Error "flow defined twice";
    RPI1009 Error "flow that is never defined";
    RPI1010 Error "arguments that do not match";
    RPI1011 Error "recursion without end";
    RPI1012 Error "defined outside";
    RPI1013 Note "value that is left open";
    RPI1014 Error "parts that do not belong together";
    RPI1015 Warning "fault in what nobody calls";
    RPI1016 Warning "module that nothing uses";
    RPI1017 Warning "parameter that nothing uses";
    RPI1101 Error "unknown primitive";
    RPI1102 Warning "unknown in-port";
    RPI1103 Error "unknown parameter";
    RPI1104 Error "unknown name in a net";
    RPI1105 Error "unknown port";
    RPI1106 Error "two meanings of one name in a net";
    RPI1107 Error "in-port or parameter given twice";
    RPI1201 Warning "link in a doc comment that leads nowhere";
    RPI2001 Error "types that do not fit";
    RPI2002 Error "dimensions that do not fit";
    RPI2003 Error "unit that is not there";
    RPI2004 Error "plain number for an angle";
    RPI2005 Error "frames that do not meet";
    RPI2006 Error "operator that does not take these operands";
    RPI2007 Error "type that nothing tells";
    RPI2008 Error "constant needed";
    RPI2009 Error "sizes that do not fit";
    RPI2010 Error "constant that can not be worked out";
    RPI2011 Error "cases that are not complete";
    RPI2012 Error "division by zero";
    RPI2013 Error "array defined by its elements the wrong way";
    RPI2014 Error "variable that stands for many values";
    RPI2015 Warning "division read as in Lustre V6";
    RPI2016 Warning "sum of times that is rounded";
    RPI2017 Error "value outside of its subrange";
    RPI2018 Error "subrange without values";
    RPI2019 Error "type that does not satisfy its constraint";
    RPI2101 Error "link between ports of different types";
    RPI2102 Error "text is no value of the parameter's type";
    RPI2103 Error "in-port not connected";
    RPI2104 Error "sizes that do not fit";
    RPI3001 Error "absent value where one is needed";
    RPI3002 Warning "`??` whose right side is never used";
    RPI3004 Error "optional part of a value";
    RPI3005 Error "function with state";
    RPI3006 Error "automaton without one initial state";
    RPI3007 Error "clocks that do not meet";
    RPI3008 Warning "operand with state that can fault";
    RPI3009 Error "delay of two clocks";
    RPI3101 Warning "flow that nothing uses";
    RPI3102 Warning "claim that can never hold";
    RPI3103 Warning "state that nothing leads to";
    RPI4001 Error "dependency cycle";
    RPI4002 Error "port that stands for itself";
    RPI4003 Error "assumption about what it allows";
    RPI5001 Error "`pre` without a first value";
    RPI5002 Error "`current` before the first tick";
    RPI5003 Warning "claim about a value that is not there";
    RPI6001 Error "device port used the wrong way";
    RPI6002 Error "actuator defined twice";
    RPI6101 Error "two writers of one actuator";
    RPI6102 Error "command that can never finish";
    RPI6103 Warning "result that can never happen";
    RPI6104 Note "set-point that may be absent";
    RPI6105 Note "exclusion of set-points not proved";
    RPI6201 Warning "successor that does not take over";
    RPI7001 Error "budget exceeded";
    RPI7002 Warning "cycle longer than its period";
    RPI7003 Error "more of a tick than commands may take";
    RPI8001 Error "end of a command in the wrong place";
    RPI8002 Error "result that nothing follows";
    RPI8003 Warning "two branches for one result";
    RPI8004 Error "value that nothing hands over";
    RPI8005 Error "device that two strands drive";
    RPI8006 Error "number of repetitions out of range";
    RPI8007 Warning "step that nothing leads to";
    RPI9001 Error "claim that does not hold";
    RPI9002 Error "claim that was never made";
    RPI9003 Error "fault while running";
    RPI9011 Error "cycle that cannot be computed";
    RPI9012 Warning "assertion that does not hold";
    RPI9013 Warning "assumption that is broken";
    RPI9014 Warning "guarantee that is not kept";
    RPI9015 Warning "no mode of a contract applies";
    RPI9021 Error "recording that cannot be run again";
    RPI9101 Error "primitive without a form in C";
    RPI9102 Warning "part of a program that a net cannot hold";
    RPI9103 Warning "primitive without a form in Lustre";
    RPI9201 Error "server that others can reach";
    RPI9901 Error "fault of the compiler";
}

impl Code {
    /// The name as it is written: `RPI4001`.
    pub fn as_str(self) -> &'static str {
        self.row().name
    }

    /// The code of that name, if there is one.
    pub fn parse(name: &str) -> Option<Code> {
        TABLE
            .iter()
            .find(|row| row.name.eq_ignore_ascii_case(name))
            .map(|row| row.code)
    }

    /// What every finding of this code has in common, in a few words.
    pub fn title(self) -> &'static str {
        self.row().title
    }

    /// Whether it is about text that does nothing, which editors show faded.
    pub fn is_about_needless_text(self) -> bool {
        matches!(
            self,
            Code::RPI1016
                | Code::RPI1017
                | Code::RPI3002
                | Code::RPI3101
                | Code::RPI3103
                | Code::RPI8007
        )
    }

    /// Whether it is about a body or bracket that does not end.
    pub fn is_about_missing_end(self) -> bool {
        self == Code::RPI0004
    }

    /// How much it weighs.
    pub fn severity(self) -> Severity {
        self.row().severity
    }

    /// The page in Markdown: what it means, a wrong and a right program, how to fix it.
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
