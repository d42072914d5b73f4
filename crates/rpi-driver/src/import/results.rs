//! Conversion of the end of a net to results of a command.

use rpi_net::{FragmentId, Input, ResultKind, Termination};

use super::{Writer, values};

/// Expression for the end of a net that does not end by itself: an input named `stop`, which the host sets.
const STOP: &str = "Core::BooleanNetcommIn<<Key: \"stop\", Value: false>>().outValue";

impl Writer<'_> {
    /// Returns the last lines of the imported command: its exports and its results.
    pub(super) fn results(&self) -> String {
        let mut text = String::from("\n");
        for export in &self.net.exports {
            let flow = self.flow(export.source, FragmentId::ROOT);
            text.push_str(&format!("export {flow};\n"));
        }
        match &self.net.termination {
            Termination::Results(results) => {
                for result in results {
                    let condition = self.root(&result.condition, "false");
                    let (kind, name) = (kind_text(result.kind), &result.name);
                    text.push_str(&format!("{kind} {name} when {condition};\n"));
                }
            }
            Termination::Ports { terminate, fail } => {
                text.push_str(&self.ports(terminate.as_ref(), fail.as_ref()));
            }
        }
        text
    }

    /// Returns the lines about the end of a net that ends by ports: it ends when `outTerminate` is true, with an error
    /// if `outFail` is then not 0. `outFail` is exported, so that clients can observe it.
    fn ports(&self, terminate: Option<&Input>, fail: Option<&Input>) -> String {
        let mut text = String::new();
        let is_false = |input: &&Input| {
            let known = self.constant(input);
            known.and_then(rpi_image::Value::as_bool) == Some(false)
        };
        let terminate = match terminate.filter(|input| !is_false(input)) {
            Some(terminate) => self.root(terminate, "false"),
            None => STOP.to_owned(),
        };
        text.push_str(&format!("outTerminate = {terminate};\n"));
        if let Some(fail) = fail {
            let fail = self.root(fail, "0");
            text.push_str(&format!("outFail = {fail};\nexport outFail;\n"));
            text.push_str("fail failed when outTerminate and outFail <> 0;\n");
        }
        text.push_str("finish done when outTerminate;\n");
        text
    }

    /// Returns the expression for an input of the root fragment of a net, with the value `absent` where the flow is
    /// absent.
    fn root(&self, input: &Input, absent: &str) -> String {
        match input {
            Input::Unconnected => absent.to_owned(),
            Input::Const(value) => values::value(value),
            Input::Port(port) => self.total(*port, FragmentId::ROOT, absent),
        }
    }
}

fn kind_text(kind: ResultKind) -> &'static str {
    match kind {
        ResultKind::Finish => "finish",
        ResultKind::Yield => "yield",
        ResultKind::Fail => "fail",
    }
}
