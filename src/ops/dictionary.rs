//! Dictionaries: XML that shaders search with paths, `dict_find` and its relatives.
//!
//! Differs from OSL, whose paths are all of XPath 1.0: here a path is steps with `/` or `//` between, each a name, `*`, `.` or `..`, with
//! conditions `[n]`, `[@name]`, `[@name='text']`, `[name]`, `[name='text']` and `[text()='text']`, and at the end `@name`, which finds the
//! nodes that have the attribute.

/// An element of a document.
#[derive(Clone, Debug, Default, PartialEq)]
struct Node {
    name: String,
    attributes: Vec<(String, String)>,
    /// The text directly inside.
    text: String,
    parent: usize,
    children: Vec<usize>,
    /// The number after the last of what is inside: nodes are numbered in the order of the text.
    end: usize,
}

/// A parsed dictionary. Node 0 stands above the root.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Dictionary {
    nodes: Vec<Node>,
}

impl Dictionary {
    /// Parses XML, or says what is wrong with it.
    pub fn parse(text: &str) -> Result<Self, String> {
        let document = roxmltree::Document::parse(text).map_err(|error| error.to_string())?;
        let mut nodes = vec![Node::default()];
        let mut numbers = std::collections::HashMap::new();
        for element in document.descendants().filter(roxmltree::Node::is_element) {
            let number = nodes.len();
            numbers.insert(element.id(), number);
            let parent = element.parent().and_then(|parent| numbers.get(&parent.id()).copied()).unwrap_or(0);
            let attributes = element.attributes().map(|a| (a.name().to_owned(), a.value().to_owned())).collect();
            let inside = element.children().filter(roxmltree::Node::is_text).filter_map(|text| text.text());
            let name = element.tag_name().name().to_owned();
            nodes[parent].children.push(number);
            nodes.push(Node {
                name,
                attributes,
                text: inside.collect(),
                parent,
                children: Vec::new(),
                end: number + 1,
            });
        }
        for number in (1..nodes.len()).rev() {
            let (parent, end) = (nodes[number].parent, nodes[number].end);
            nodes[parent].end = nodes[parent].end.max(end);
        }
        Ok(Dictionary { nodes })
    }

    /// The nodes that a path finds from a node, in the order of the text; 0 is above the root. Nothing for what is no path.
    pub fn find(&self, from: usize, path: &str) -> Option<Vec<usize>> {
        let path = path.trim();
        let mut found = if path.starts_with('/') { vec![0] } else { vec![from] };
        for (deep, step) in steps(path)? {
            found = self.step(&found, step, deep);
        }
        Some(found)
    }

    fn step(&self, from: &[usize], step: &str, deep: bool) -> Vec<usize> {
        let (test, conditions) = step.split_at(step.find('[').unwrap_or(step.len()));
        let mut out = Vec::new();
        // What lies below several nodes is looked at once.
        let inside = if deep { vec![self.below(from)] } else { Vec::new() };
        let starts = from.iter().map(|&node| match test {
            "." | "text()" => vec![node],
            ".." => vec![self.nodes[node].parent],
            _ if test.starts_with('@') => vec![node],
            _ => self.nodes[node].children.clone(),
        });
        let lists: Vec<Vec<usize>> = if deep { inside } else { starts.collect() };
        for mut near in lists {
            near.retain(|&at| self.passes(at, test));
            for condition in conditions.split('[').skip(1) {
                let condition = condition.trim_end_matches(']').trim();
                near = match condition.parse::<usize>() {
                    Ok(number) => near.get(number.wrapping_sub(1)).copied().into_iter().collect(),
                    Err(_) => near.into_iter().filter(|&at| self.holds(at, condition)).collect(),
                };
            }
            out.extend(near);
        }
        out.sort_unstable();
        out.dedup();
        out
    }

    /// All nodes below some, which are in the order of the text.
    fn below(&self, from: &[usize]) -> Vec<usize> {
        let mut out: Vec<usize> = Vec::new();
        for &node in from {
            let first = out.last().map_or(0, |last| last + 1).max(node + 1);
            out.extend(first..self.nodes[node].end.max(first));
        }
        out
    }

    fn passes(&self, node: usize, test: &str) -> bool {
        match test.strip_prefix('@') {
            Some(name) => self.attribute(node, name).is_some(),
            // The text of an element is its value of no name, so that the element stands for it.
            None if test == "text()" => !self.nodes[node].text.trim().is_empty(),
            None => matches!(test, "*" | "." | "..") || self.nodes[node].name == test,
        }
    }

    /// `@name`, `name`, and either or `text()` with `= 'text'`.
    fn holds(&self, node: usize, condition: &str) -> bool {
        let (left, right) = match condition.split_once('=') {
            Some((left, right)) => (left.trim(), Some(right.trim().trim_matches(['"', '\'']))),
            None => (condition, None),
        };
        let is = |text: &str| right.is_none_or(|right| right == text);
        if left == "text()" {
            return is(&self.nodes[node].text);
        }
        match left.strip_prefix('@') {
            Some(name) => self.attribute(node, name).is_some_and(is),
            None => self.nodes[node].children.iter().any(|&at| self.nodes[at].name == left && is(&self.nodes[at].text)),
        }
    }

    fn attribute(&self, node: usize, name: &str) -> Option<&str> {
        self.nodes[node].attributes.iter().find(|(own, _)| own == name).map(|(_, value)| value.as_str())
    }

    /// An attribute of a node; with an empty name the text inside it.
    pub fn value(&self, node: usize, name: &str) -> Option<&str> {
        match (self.nodes.get(node), name) {
            (Some(node), "") => Some(&node.text),
            (Some(_), name) => self.attribute(node, name),
            (None, _) => None,
        }
    }
}

/// The steps of a path, and whether each looks deep; nothing where one is empty or a bracket or quote is not closed.
fn steps(path: &str) -> Option<Vec<(bool, &str)>> {
    let (mut rest, mut out) = (path, Vec::new());
    while !rest.is_empty() {
        let deep = rest.starts_with("//");
        rest = rest.strip_prefix("//").or_else(|| rest.strip_prefix('/')).unwrap_or(rest);
        let (step, after) = rest.split_at(step_end(rest)?);
        if step.is_empty() || step.starts_with('[') {
            return None;
        }
        out.push((deep, step));
        rest = after;
    }
    Some(out)
}

/// Where a step of a path ends: at a slash that is in no condition.
fn step_end(path: &str) -> Option<usize> {
    let (mut depth, mut quote) = (0u32, None);
    for (at, c) in path.char_indices() {
        match (c, quote) {
            (c, Some(open)) if c == open => quote = None,
            (_, Some(_)) => {}
            ('"' | '\'', None) => quote = Some(c),
            ('[', None) => depth += 1,
            (']', None) => depth = depth.checked_sub(1)?,
            ('/', None) if depth == 0 => return Some(at),
            _ => {}
        }
    }
    (depth == 0 && quote.is_none()).then_some(path.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_find_what_they_name() {
        let text = r#"<list><item id="a" x="1">one</item><group><item id="b"><name>deep</name></item></group><item id="c"/></list>"#;
        let dictionary = Dictionary::parse(text).unwrap();
        let ids = |path: &str| {
            let found = dictionary.find(0, path).unwrap();
            found.iter().map(|&at| dictionary.value(at, "id").unwrap_or("-").to_owned()).collect::<String>()
        };
        for (path, found) in [
            ("//item", "abc"),
            ("/list/item", "ac"),
            ("list/*", "a-c"),
            ("//item[@id='b']", "b"),
            ("//item[2]", "b"),
            ("/list/item[2]", "c"),
            ("//item[@x]", "a"),
            ("//item[name='deep']", "b"),
            ("//item[text()='one']", "a"),
            ("//item/@x", "a"),
            ("//name/..", "b"),
            ("//nothing", ""),
            ("//item[@id='a']/text()", "a"),
            ("//text()", "a-"),
        ] {
            assert_eq!(ids(path), found, "{path}");
        }
        for path in ["//[[", "///", "a[", "a]", "a//", "/", "a[x=']"] {
            assert_eq!(dictionary.find(0, path), None, "{path}");
        }
        let group = dictionary.find(0, "/list/group").unwrap()[0];
        assert_eq!(dictionary.find(group, "item").unwrap().len(), 1);
        assert_eq!(dictionary.value(dictionary.find(0, "//item").unwrap()[0], ""), Some("one"));
        assert!(Dictionary::parse("<a>").is_err());
    }
}
