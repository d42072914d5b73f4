//! Name, role and rights of a client.

use serde_json::Value;

/// Identity of a client as the server sees it: name, role and rights.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Identity {
    /// Name of the token of the client; `None` if the server has no tokens.
    pub name: Option<String>,
    /// Role of the client: `viewer`, `operator`, `programmer` or `admin`.
    pub role: String,
    /// Rights of the role of the client: some of `watch`, `stop`, `move`, `load`, `reset`, `release`, `manage`.
    pub rights: Vec<String>,
}

impl Identity {
    pub(crate) fn from_json(described: &Value) -> Identity {
        let rights = described["rights"].as_array();
        let rights = rights.into_iter().flatten().filter_map(Value::as_str);
        Identity {
            name: described["name"].as_str().map(str::to_owned),
            role: described["role"].as_str().unwrap_or_default().to_owned(),
            rights: rights.map(str::to_owned).collect(),
        }
    }

    /// Returns true if the client has the right with this name, such as `move`.
    #[must_use]
    pub fn may(&self, right: &str) -> bool {
        self.rights.iter().any(|having| having == right)
    }
}
