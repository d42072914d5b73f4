//! Tree of the links of a URDF, and the joints between two of its links.

use super::urdf_joint::{UrdfError, UrdfJoint, UrdfJointType};
use crate::cell::words::did_you_mean;
use core::ops::Range;
use std::collections::BTreeMap;

/// Links and joints of a URDF, which form a tree.
pub(super) struct UrdfTree {
    pub(super) links: Vec<String>,
    pub(super) joints: Vec<UrdfJoint>,
    /// Index of the joint that connects each link to its parent, by the name of the link.
    above: BTreeMap<String, usize>,
    /// Byte range of the element `robot`, for errors that concern the whole tree.
    span: Range<usize>,
}

impl UrdfTree {
    pub(super) fn new(
        links: Vec<String>,
        joints: Vec<UrdfJoint>,
        span: Range<usize>,
    ) -> Result<Self, UrdfError> {
        let mut above = BTreeMap::new();
        for (number, joint) in joints.iter().enumerate() {
            for link in [&joint.parent, &joint.child] {
                if !links.contains(link) {
                    let message = format!("joint `{}` names the unknown link `{link}`", joint.name);
                    return Err((joint.span.clone(), message, Some(named(link, &links))));
                }
            }
            if above.insert(joint.child.clone(), number).is_some() {
                let message = format!("link `{}` is the child of two joints", joint.child);
                return Err((joint.span.clone(), message, None));
            }
        }
        Ok(Self {
            links,
            joints,
            above,
            span,
        })
    }

    fn error(&self, message: String, help: Option<String>) -> UrdfError {
        (self.span.clone(), message, help)
    }

    /// Returns the joints from the link `base` (`None` for the root) to the link `tip` (`None` for the end of the
    /// longest chain), in order.
    pub(super) fn path(
        &self,
        base: Option<&str>,
        tip: Option<&str>,
    ) -> Result<Vec<&UrdfJoint>, UrdfError> {
        for (key, link) in [("base", base), ("tip", tip)] {
            let link = link.filter(|link| !self.links.iter().any(|known| known == link));
            if let Some(link) = link {
                let message = format!("`{key}` is the unknown link `{link}`");
                return Err(self.error(message, Some(named(link, &self.links))));
            }
        }
        let tip = match tip {
            Some(tip) => tip,
            None => self.longest()?,
        };
        let path = self.up_to(tip, base)?;
        if path.iter().any(|joint| is_movable(joint)) {
            return Ok(path);
        }
        Err(self.error(format!("no movable joint leads to link `{tip}`"), None))
    }

    /// Returns the joints from the link `base` (`None` for the root) to the link `tip`, in order. Joints that form a
    /// cycle are an error.
    fn up_to(&self, tip: &str, base: Option<&str>) -> Result<Vec<&UrdfJoint>, UrdfError> {
        let (mut path, mut link) = (Vec::new(), tip);
        while Some(link) != base {
            let Some(&number) = self.above.get(link) else {
                break;
            };
            path.push(&self.joints[number]);
            link = &self.joints[number].parent;
            if path.len() > self.joints.len() {
                return Err(self.error(format!("the joints above `{tip}` form a cycle"), None));
            }
        }
        if base.is_some_and(|base| base != link) {
            let message = format!(
                "link `{tip}` is not below the base `{}`",
                base.unwrap_or("")
            );
            return Err(self.error(message, None));
        }
        path.reverse();
        Ok(path)
    }

    /// Returns the link at the end of the chain with the most movable joints. Of several links behind the same joints,
    /// the one with a usual name for a flange is taken, else the first one. Several such chains are an error.
    fn longest(&self) -> Result<&str, UrdfError> {
        let mut counts = Vec::new();
        for link in &self.links {
            let path = self.up_to(link, None)?;
            let movable: Vec<&str> = path
                .iter()
                .filter(|joint| is_movable(joint))
                .map(|joint| joint.name.as_str())
                .collect();
            counts.push((link.as_str(), movable));
        }
        let most = counts.iter().map(|(_, movable)| movable.len()).max();
        counts.retain(|(_, movable)| Some(movable.len()) == most);
        let same = counts.windows(2).all(|pair| pair[0].1 == pair[1].1);
        let ends: Vec<&str> = counts.iter().map(|(link, _)| *link).collect();
        let usual = FLANGES.iter().find(|name| ends.contains(name)).copied();
        match (same, usual, ends.first()) {
            (true, Some(name), _) => Ok(name),
            (true, None, Some(first)) => Ok(first),
            _ => {
                let help = format!("write [urdf] with tip = \"..\": {}", some_of(&ends));
                Err(self.error("several chains are the longest".to_owned(), Some(help)))
            }
        }
    }
}

/// Usual names for the link at the flange, in the order of preference, by ROS-Industrial and the vendors of arms.
const FLANGES: &[&str] = &["tool0", "flange", "ee_link", "tcp"];

/// True if a joint is an axis of its own: it moves and does not follow another joint.
pub(super) fn is_movable(joint: &UrdfJoint) -> bool {
    joint.kind != UrdfJointType::Fixed && joint.mimic.is_none()
}

fn named(link: &str, links: &[String]) -> String {
    let links: Vec<&str> = links.iter().map(String::as_str).collect();
    match did_you_mean(link, &links) {
        near if near.starts_with("did") => near,
        _ => format!("links: {}", some_of(&links)),
    }
}

/// Returns the first names of a list, separated by commas, so that a message about a large robot stays short.
fn some_of(names: &[&str]) -> String {
    const SHOWN: usize = 12;
    let more = if names.len() > SHOWN { ", .." } else { "" };
    format!("{}{more}", names[..names.len().min(SHOWN)].join(", "))
}
