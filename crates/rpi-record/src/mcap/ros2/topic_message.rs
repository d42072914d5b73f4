//! ROS 2 messages for topics with flows or ports: a message type of its own for each topic.

use rpi_image::{Scalar, Type};

use super::cdr::CdrWriter;
use super::definitions;
use crate::mcap::field_tree::FieldTree;
use crate::mcap::names::FlowName;
use crate::mcap::topic::Topic;

/// Layout of the ROS 2 message of a topic: the name of its type, and its fields in the order of encoding.
#[derive(Clone, Debug)]
pub(in crate::mcap) struct MessageLayout {
    /// Name of the message type within the package `rpi_msgs`.
    name: String,
    fields: Vec<MessageField>,
}

/// Field of a ROS 2 message: its name, its type, and the fields of the topic from which its value comes.
#[derive(Clone, Debug)]
struct MessageField {
    /// Name of the field by the rules of ROS: lower-case letters, digits and single underscores.
    name: String,
    /// Scalar type of the value, or of the elements if the value is an array.
    scalar: Scalar,
    value: MessageValue,
}

/// Source of the value of a field of a ROS 2 message, as indices of fields of the topic.
#[derive(Clone, Debug)]
enum MessageValue {
    /// One value: the field of the topic with this index.
    One(usize),
    /// An array: the field of the topic with this index, whose value is an array or a matrix.
    Array(usize),
    /// An array of several fields of the topic with these indices; `None` for an element without a field.
    List(Vec<Option<usize>>),
}

impl MessageLayout {
    /// Creates the layout of the ROS 2 message for a topic.
    pub(in crate::mcap) fn of(topic: &Topic) -> MessageLayout {
        let mut fields = Vec::new();
        collect(&topic.tree, "", &topic.fields, &mut fields);
        make_unique(&mut fields);
        MessageLayout {
            name: type_name(&topic.name),
            fields,
        }
    }

    /// Returns the full name of the message type, such as `rpi_msgs/msg/CommandMoveToE`.
    pub(in crate::mcap) fn full_name(&self) -> String {
        format!("rpi_msgs/msg/{}", self.name)
    }

    /// Returns the schema of the message type: its definition with those of all messages that it uses.
    pub(in crate::mcap) fn schema(&self) -> String {
        let mut text = "std_msgs/Header header\nuint64 cycle\n".to_owned();
        let mut uses = vec!["std_msgs/Header"];
        for field in &self.fields {
            let ty = ros_type(field.scalar);
            let brackets = match field.value {
                MessageValue::One(_) => "",
                MessageValue::Array(_) | MessageValue::List(_) => "[]",
            };
            text += &format!("{ty}{brackets} {}\n", field.name);
            if ty.contains('/') {
                uses.push(ty);
            }
        }
        text += "# Names of the fields that have no value in this cycle.\nstring[] absent\n";
        definitions::with_uses(&text, &uses)
    }

    /// Encodes the values of one cycle as a message in CDR. `time` is in nanoseconds since the Unix epoch, `cycle` is
    /// the number of the cycle; `values` holds the memory words of each field of the topic, `None` for an absent one.
    pub(in crate::mcap) fn encode(
        &self,
        (time, cycle): (u64, u64),
        values: &[Option<&[u64]>],
    ) -> Vec<u8> {
        let mut cdr = CdrWriter::new();
        cdr.header(time, "");
        cdr.u64(cycle);
        let mut absent = Vec::new();
        for field in &self.fields {
            if !field.encode(&mut cdr, values) {
                absent.push(field.name.as_str());
            }
        }
        cdr.len(absent.len());
        absent.into_iter().for_each(|name| cdr.string(name));
        cdr.finish()
    }
}

impl MessageField {
    /// Encodes the field from the values of the topic's fields. Returns false if all its values are absent.
    fn encode(&self, cdr: &mut CdrWriter, values: &[Option<&[u64]>]) -> bool {
        let slots = self.scalar.slots() as usize;
        match &self.value {
            MessageValue::One(field) => {
                put(cdr, self.scalar, values[*field]);
                values[*field].is_some()
            }
            MessageValue::Array(field) => {
                let cells = values[*field].unwrap_or(&[]);
                cdr.len(cells.len() / slots);
                let each = cells.chunks_exact(slots);
                each.for_each(|cells| put(cdr, self.scalar, Some(cells)));
                values[*field].is_some()
            }
            MessageValue::List(fields) => {
                cdr.len(fields.len());
                let each = fields.iter().map(|field| field.and_then(|at| values[at]));
                each.clone().for_each(|cells| put(cdr, self.scalar, cells));
                each.into_iter().any(|cells| cells.is_some())
            }
        }
    }
}

/// Appends to `fields` the message fields for a node of a topic's tree and everything below it. `name` is the path of
/// the node, `own` are the fields of the topic.
fn collect(tree: &FieldTree, name: &str, own: &[FlowName], fields: &mut Vec<MessageField>) {
    match tree {
        FieldTree::Gap => {}
        FieldTree::Field(at) => fields.push(single(name, *at, own[*at].ty)),
        FieldTree::Object(members) => {
            for (member, tree) in members {
                collect(tree, &joined(name, member), own, fields);
            }
        }
        FieldTree::List(elements) => match list_of(elements, own) {
            Some((scalar, list)) => fields.push(MessageField {
                name: field_name(name),
                scalar,
                value: MessageValue::List(list),
            }),
            None => {
                for (k, tree) in elements.iter().enumerate() {
                    collect(tree, &joined(name, &k.to_string()), own, fields);
                }
            }
        },
    }
}

fn single(name: &str, at: usize, ty: Type) -> MessageField {
    let (scalar, value) = match ty {
        Type::Scalar(scalar) => (scalar, MessageValue::One(at)),
        Type::Array(scalar, _) => (scalar, MessageValue::Array(at)),
        Type::Matrix(..) => (Scalar::Real, MessageValue::Array(at)),
    };
    MessageField {
        name: field_name(name),
        scalar,
        value,
    }
}

/// Returns the scalar type and the field indices of a list whose elements are all values of the same scalar type;
/// `None` for any other list.
fn list_of(elements: &[FieldTree], own: &[FlowName]) -> Option<(Scalar, Vec<Option<usize>>)> {
    let field = |tree: &FieldTree| match tree {
        FieldTree::Gap => Some(None),
        FieldTree::Field(at) => Some(Some(*at)),
        _ => None,
    };
    let list: Vec<Option<usize>> = elements.iter().map(field).collect::<Option<_>>()?;
    let mut types = list.iter().flatten().map(|at| own[*at].ty);
    let Type::Scalar(scalar) = types.next()? else {
        return None;
    };
    let same = types.all(|ty| ty == Type::Scalar(scalar));
    same.then_some((scalar, list))
}

fn joined(name: &str, member: &str) -> String {
    match name {
        "" => member.to_owned(),
        _ => format!("{name}_{member}"),
    }
}

/// Converts a name to one by the rules of ROS for fields: it begins with a letter, and underscores are single and not
/// at the end.
fn field_name(name: &str) -> String {
    let lower = name.to_lowercase();
    let parts = lower.split(|c: char| !c.is_ascii_alphanumeric());
    let parts: Vec<&str> = parts.filter(|part| !part.is_empty()).collect();
    let joined = parts.join("_");
    match joined.starts_with(|c: char| c.is_ascii_alphabetic()) {
        true => joined,
        false => format!("f_{joined}").trim_end_matches('_').to_owned(),
    }
}

/// Names of the fields that every message of a topic has for itself.
const RESERVED: [&str; 3] = ["header", "cycle", "absent"];

/// Appends numbers to the names of fields that would otherwise be equal to each other or to a reserved name.
fn make_unique(fields: &mut [MessageField]) {
    let mut taken: Vec<String> = RESERVED.map(str::to_owned).to_vec();
    for field in fields {
        let plain = field.name.clone();
        let mut number = 1;
        while taken.contains(&field.name) {
            number += 1;
            field.name = format!("{plain}_{number}");
        }
        taken.push(field.name.clone());
    }
}

/// Returns the name of the ROS 2 message type for a topic: `CommandMoveToE` for `/command/MoveToE`.
fn type_name(topic: &str) -> String {
    let parts = topic.split(|c: char| !c.is_ascii_alphanumeric());
    let capital = |part: &str| {
        let mut letters = part.chars();
        let first = letters.next().map(|c| c.to_ascii_uppercase());
        first.into_iter().chain(letters).collect::<String>()
    };
    parts.map(capital).collect()
}

fn ros_type(scalar: Scalar) -> &'static str {
    match scalar {
        Scalar::Bool => "bool",
        Scalar::Int | Scalar::Time => "int64",
        Scalar::Real => "float64",
        Scalar::Vector => "geometry_msgs/Vector3",
        Scalar::Rotation => "geometry_msgs/Quaternion",
        Scalar::Pose => "geometry_msgs/Pose",
        Scalar::Twist => "geometry_msgs/Twist",
        Scalar::Wrench => "geometry_msgs/Wrench",
    }
}

/// Appends a value of this scalar type to a message. `cells` are its memory words; `None`, an absent value, is written
/// as NaN for reals and as zero otherwise.
fn put(cdr: &mut CdrWriter, scalar: Scalar, cells: Option<&[u64]>) {
    match scalar {
        Scalar::Bool => cdr.bool(cells.is_some_and(|cells| cells[0] != 0)),
        Scalar::Int | Scalar::Time => cdr.u64(cells.map_or(0, |cells| cells[0])),
        // A pose and the like are their reals in the order of the slots.
        _ => {
            let absent = f64::NAN.to_bits();
            let count = scalar.slots() as usize;
            (0..count).for_each(|k| cdr.u64(cells.map_or(absent, |cells| cells[k])));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn field(name: &str, ty: Type) -> FlowName {
        FlowName {
            owner: "arm".to_owned(),
            name: name.to_owned(),
            ty,
            unit: String::new(),
        }
    }

    #[test]
    fn a_topic_becomes_a_message_type() {
        let (real, pose) = (Scalar::Real.into(), Scalar::Pose.into());
        let fields = vec![
            field("joint.position[1]", real),
            field("Way", real),
            field("way", pose),
            field("list", Type::Array(Scalar::Int, 2)),
        ];
        let layout = MessageLayout::of(&Topic::new("device", "arm two", fields));
        assert_eq!(layout.full_name(), "rpi_msgs/msg/DeviceArmTwo");
        let schema = layout.schema();
        let own = schema.split("===").next().unwrap_or_default();
        assert_eq!(
            own,
            "std_msgs/Header header\nuint64 cycle\nfloat64[] joint_position\nfloat64 way\ngeometry_msgs/Pose way_2\n\
             int64[] list\n# Names of the fields that have no value in this cycle.\nstring[] absent\n"
        );
        assert!(schema.contains("MSG: geometry_msgs/Point\n"), "{schema}");
        let message = layout.encode((0, 5), &[Some(&[7]), None, None, Some(&[1, 2])]);
        // Header (4), stamp (8), empty frame (5, padded to 8), cycle (8): the list begins at 28.
        assert_eq!(message[20], 5);
        assert_eq!(message[28], 2, "the element without a field counts");
    }
}
