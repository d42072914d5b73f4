//! Members: of the value before a dot, of a struct type, and the results of a command.

use std::collections::BTreeSet;

use lsp_types::CompletionItemKind;
use rpi_diag::FileId;
use rpi_driver::Inspection;
use rpi_image::Scalar;
use rpi_prims::PrimId;
use rpi_sema::query::{DefId, DefKind, FlowType, spatial_parts};
use rpi_sema::ty::Ty;
use rpi_syntax::ast::PortKind;

use super::candidate::{Candidate, Group};
use super::items::ItemCollector;
use super::place::MemberPath;

/// Returns the members of the value or declaration to which a path leads: fields, ports, results, inner flows. On the
/// left of an equation (`is_target`), a device has only its actuators.
pub(super) fn members(
    collector: &ItemCollector<'_>,
    path: &MemberPath,
    is_target: bool,
) -> Vec<Candidate> {
    let Some(last) = resolve(collector.analysis, collector.offset, path) else {
        return match spatial_part(collector, path) {
            Some(part) => parts(Some(part)),
            None => primitive_ports(path),
        };
    };
    let index = collector.analysis.index();
    let is_possible = |id: &DefId| {
        let is_port = index.def(*id).kind == DefKind::Port;
        !is_target || !is_port || collector.port_kind(*id) == Some(PortKind::Actuator)
    };
    let members = index.members(last).into_iter().filter(is_possible);
    let members = members.map(|id| collector.def_candidate(Group::Local, id));
    let scalar = spatial_type(collector.analysis, last);
    members.chain(parts(scalar)).collect()
}

/// Returns the declaration to which a path of names such as `arm.pose` leads at an offset; `None` if a name is
/// undefined.
pub(super) fn resolve(seen: &Inspection, offset: u32, path: &MemberPath) -> Option<DefId> {
    let index = seen.index();
    let root = index.resolve(FileId(0), offset, &path.root)?;
    let only = |id: DefId| match index.members(id)[..] {
        [one] => one,
        _ => id,
    };
    let root = if path.is_call { only(root) } else { root };
    let mut names = path.rest.iter();
    names.try_fold(root, |owner, name| index.member(owner, name))
}

/// Returns the spatial type, such as pose, of a definition; `None` for any other type.
fn spatial_type(seen: &Inspection, id: DefId) -> Option<Scalar> {
    let def = seen.index().def(id);
    if let Some(FlowType { ty, .. }) = seen.types_of(def).first() {
        return match ty {
            Ty::Spatial(scalar, _) => Some(*scalar),
            _ => None,
        };
    }
    // Constants are no flows; their declared type is `Pose`, or `Pose(tool in base)`.
    let written = def.ty.map(|span| seen.sources.slice(span))?;
    let name = written.split(|c: char| !c.is_alphanumeric()).next()?;
    let mut all = Scalar::ALL.iter().copied();
    all.find(|scalar| scalar.to_string() == name)
}

/// Returns the type of the part at the end of a path such as `pose.position`; `None` if the path is something else.
fn spatial_part(collector: &ItemCollector<'_>, path: &MemberPath) -> Option<Scalar> {
    let (part, rest) = path.rest.split_last()?;
    let whole = MemberPath {
        rest: rest.to_vec(),
        ..path.clone()
    };
    let owner = resolve(collector.analysis, collector.offset, &whole)?;
    let scalar = spatial_type(collector.analysis, owner)?;
    let is_part = spatial_parts(scalar).any(|name| name == part);
    match (scalar, part.as_str()) {
        (Scalar::Pose, "rotation") => Some(Scalar::Rotation),
        // The parts of poses, twists and wrenches are vectors; those of vectors are numbers.
        (Scalar::Pose | Scalar::Twist | Scalar::Wrench, _) => is_part.then_some(Scalar::Vector),
        _ => None,
    }
}

/// Returns the parts of a value of a spatial type, such as the position and the rotation of a pose.
fn parts(scalar: Option<Scalar>) -> Vec<Candidate> {
    let part = |name: &str| Candidate::new(Group::Local, name, CompletionItemKind::PROPERTY);
    scalar
        .into_iter()
        .flat_map(spatial_parts)
        .map(part)
        .collect()
}

/// Returns the out-ports of a primitive that is called before the dot.
fn primitive_ports(path: &MemberPath) -> Vec<Candidate> {
    let prim = PrimId::from_name(&path.root).filter(|_| path.is_call && path.rest.is_empty());
    let ports = prim.map_or(&[][..], |prim| prim.desc().outputs);
    let port = |name: &str| Candidate::new(Group::Local, name, CompletionItemKind::PROPERTY);
    ports.iter().map(|one| port(one.name)).collect()
}

/// Returns the results of a command with this name.
pub(super) fn results(collector: &ItemCollector<'_>, callee: &str) -> Vec<Candidate> {
    let index = collector.analysis.index();
    let command = index.resolve(FileId(0), collector.offset, callee);
    let members = command.map(|id| index.members(id)).unwrap_or_default();
    let mut names = BTreeSet::new();
    let new = |id: DefId| collector.def_candidate(Group::Local, id);
    let distinct = members
        .into_iter()
        .filter(|id| names.insert(index.def(*id).name.clone()));
    distinct.map(new).collect()
}

/// Returns `name = ` for each field of a struct type without a value so far.
pub(super) fn fields(collector: &ItemCollector<'_>, ty: &str, given: &[String]) -> Vec<Candidate> {
    let index = collector.analysis.index();
    let ty = index.resolve(FileId(0), collector.offset, ty);
    let members = ty.map(|id| index.members(id)).unwrap_or_default();
    let is_open = |id: &DefId| !given.iter().any(|name| *name == *index.def(*id).name);
    let new = |id: DefId| {
        let text = format!("{} = ", index.def(id).name);
        collector.def_candidate(Group::Local, id).with_text(text)
    };
    members.into_iter().filter(is_open).map(new).collect()
}
