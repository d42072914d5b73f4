//! Topics of a recording for viewers: their names, fields and the encoding of their messages.

use std::sync::Arc;

use serde_json::{Map, Value, json};

use super::field_tree::FieldTree;
use super::names::FlowName;
use super::value_json;

/// Topic of a recording for viewers. Its messages have one field for each flow of a command or port of a device.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(super) struct Topic {
    /// Name of the topic, such as `/command/MoveToE`.
    pub(super) name: String,
    /// Names and types of the fields of the topic's messages.
    pub(super) fields: Vec<FlowName>,
    /// Tree of the fields in a message: nested objects and lists.
    pub(super) tree: FieldTree,
}

impl Topic {
    /// Creates the topic `/KIND/OWNER` with these fields. `owner` is the name of the command or device.
    pub(super) fn new(kind: &str, owner: &str, fields: Vec<FlowName>) -> Arc<Topic> {
        let tree = FieldTree::from_names(fields.iter().map(|f| f.name.as_str()));
        Arc::new(Topic {
            name: format!("/{kind}/{owner}"),
            fields,
            tree,
        })
    }

    /// Returns the JSON schema of the topic's messages.
    pub(super) fn json_schema(&self) -> Value {
        let mut schema = self.schema_of(&self.tree);
        let mut properties = Map::new();
        properties.insert("cycle".into(), json!({ "type": "integer" }));
        if let Some(Value::Object(own)) = schema.get_mut("properties").map(Value::take) {
            properties.extend(own);
        }
        schema["properties"] = Value::Object(properties);
        schema
    }

    fn schema_of(&self, tree: &FieldTree) -> Value {
        match tree {
            FieldTree::Gap => json!({ "type": "null" }),
            FieldTree::Field(field) => value_json::schema(self.fields[*field].ty),
            FieldTree::Object(members) => {
                let members = members.iter().map(|(n, t)| (n.clone(), self.schema_of(t)));
                json!({ "type": "object", "properties": members.collect::<Map<_, _>>() })
            }
            FieldTree::List(elements) => {
                let first = elements.iter().find(|e| **e != FieldTree::Gap);
                let items = first.map_or(json!({}), |e| self.schema_of(e));
                json!({ "type": "array", "items": items })
            }
        }
    }

    /// Returns a message of the topic as JSON text: the cycle number and the values of the fields. Each value holds
    /// memory words; an absent value (`None`) is `null`.
    pub(super) fn to_json(&self, cycle: u64, values: &[Option<&[u64]>]) -> String {
        let mut out = format!("{{\"cycle\":{cycle}");
        if let FieldTree::Object(members) = &self.tree {
            for (name, tree) in members {
                out.push(',');
                self.write_member(&mut out, name, tree, values);
            }
        }
        out.push('}');
        out
    }

    fn write_member(
        &self,
        out: &mut String,
        name: &str,
        tree: &FieldTree,
        values: &[Option<&[u64]>],
    ) {
        out.push_str(&Value::from(name).to_string());
        out.push(':');
        self.write(out, tree, values);
    }

    fn write(&self, out: &mut String, tree: &FieldTree, values: &[Option<&[u64]>]) {
        match tree {
            FieldTree::Gap => out.push_str("null"),
            FieldTree::Field(field) => {
                value_json::write(out, values[*field], self.fields[*field].ty);
            }
            FieldTree::Object(members) => {
                out.push('{');
                for (k, (name, tree)) in members.iter().enumerate() {
                    out.push_str(if k > 0 { "," } else { "" });
                    self.write_member(out, name, tree, values);
                }
                out.push('}');
            }
            FieldTree::List(elements) => {
                out.push('[');
                for (k, tree) in elements.iter().enumerate() {
                    out.push_str(if k > 0 { "," } else { "" });
                    self.write(out, tree, values);
                }
                out.push(']');
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use rpi_image::{Scalar, Type};

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
    fn messages_are_nested_like_the_names_of_their_fields() {
        let real = Type::Scalar(Scalar::Real);
        let fields = ["joint.position[0]", "joint.position[1]", "moving"];
        let fields = fields.map(|name| field(name, real)).to_vec();
        let topic = Topic::new("device", "arm", fields);
        assert_eq!(topic.name, "/device/arm");
        let [one, two] = [1.5_f64.to_bits(), 2.0_f64.to_bits()];
        let text = topic.to_json(7, &[Some(&[one]), None, Some(&[two])]);
        assert_eq!(
            text,
            r#"{"cycle":7,"joint":{"position":[1.5,null]},"moving":2.0}"#
        );
        let schema = topic.json_schema();
        let position = &schema["properties"]["joint"]["properties"]["position"];
        assert_eq!(position["items"]["type"], "number", "{schema}");
        assert_eq!(schema["properties"]["cycle"]["type"], "integer");
    }
}
