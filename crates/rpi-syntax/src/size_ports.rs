//! The `const` in-ports of Kind 2 that determine array sizes.

use crate::ast::*;

/// Returns the `const` in-ports of a node that occur in the array size of a port or local, as constant definitions
/// without values.
pub(crate) fn size_params(signature: &Signature, definition: &NodeDef) -> Vec<ConstDef> {
    let inputs = signature.inputs.as_deref().unwrap_or_default();
    if !inputs.iter().any(|port| port.is_const) {
        return Vec::new();
    }
    let outputs = signature.outputs.as_deref().unwrap_or_default();
    let mut sized: Vec<&Type> = inputs.iter().chain(outputs).map(|port| &port.ty).collect();
    if let NodeDef::Body(body) = definition {
        let locals = body.locals.iter().flat_map(|section| match section {
            Locals::Var(vars) => &vars[..],
            Locals::Const(_) => &[],
        });
        sized.extend(locals.map(|var| &var.ty));
    }
    let decides = |name: &Ident| sized.iter().any(|ty| size_mentions(ty, &name.name));
    let mut sizes = Vec::new();
    for port in inputs.iter().filter(|port| port.is_const) {
        let names: Vec<Ident> = port
            .names
            .iter()
            .filter(|name| decides(name))
            .cloned()
            .collect();
        if !names.is_empty() {
            sizes.push(ConstDef {
                doc: None,
                names,
                ty: Some(port.ty.clone()),
                value: None,
                span: port.span,
            });
        }
    }
    sizes
}

/// Returns whether an array size in the type `ty` refers to the name.
fn size_mentions(ty: &Type, name: &Name) -> bool {
    match &ty.kind {
        TypeKind::Array(array) => {
            mentions(&array.size, name) || size_mentions(&array.element, name)
        }
        TypeKind::Optional(inner) => size_mentions(inner, name),
        TypeKind::Tuple(types) => types.iter().any(|ty| size_mentions(ty, name)),
        TypeKind::Refinement(refined) => size_mentions(&refined.base, name),
        _ => false,
    }
}

fn mentions(expr: &Expr, name: &Name) -> bool {
    expr.as_name() == Some(name) || expr.children().into_iter().any(|part| mentions(part, name))
}
