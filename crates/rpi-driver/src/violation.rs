//! Reporting of invalid nets produced by a compiler stage.

use rpi_diag::{Diagnostic, Span};
use rpi_net::VerifyError;

/// Converts an error of the net verifier, which means that a compiler stage has produced an invalid net, to a
/// diagnostic. `around` is the location of the node or command that was being compiled.
pub(crate) fn diagnostic(violation: &VerifyError, around: Span) -> Diagnostic {
    let message = format!("the compiler produced an invalid net: {violation}");
    let place = match violation.span() {
        Span::NONE => around,
        place => place,
    };
    Diagnostic::internal_error(message, place)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rpi_diag::Code;
    use rpi_net::passes::analyse;
    use rpi_net::{Input, NodeId, PortRef};

    #[test]
    fn a_net_out_of_order_is_a_finding_at_its_place() {
        let text = "{a=Core::BooleanNot(inValue=b.outCancel),b=Cancel()}";
        let (net, diagnostics) = rpi_net::rpinet::parse("Net", rpi_diag::FileId(0), text);
        let mut net = net.unwrap_or_else(|| panic!("{diagnostics:?}"));
        net.nodes[0].inputs[0] = Input::Port(PortRef {
            node: NodeId(7),
            port: 0,
        });
        let place = net.nodes[0].origin.span;
        let violation = analyse(net, |_| false).unwrap_err();
        let diagnostic = diagnostic(&violation, Span::NONE);
        assert_eq!((diagnostic.code, diagnostic.span()), (Code::RPI9901, place));
        assert_ne!(place, Span::NONE);
    }
}
