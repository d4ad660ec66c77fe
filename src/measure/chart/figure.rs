//! What a figure of the chart holds: methods with their cost and error, and which of them no other beats.

use super::race::Cost;

/// One method, or one setting of a method.
#[derive(Clone, Debug, PartialEq)]
pub struct Point {
    /// Methods of one group compete with each other; drawn in one color.
    pub group: String,
    /// What a label says.
    pub method: String,
    /// Median cost in the unit of the figure.
    pub cost: f64,
    /// Lower and upper quartile of the cost.
    pub spread: [f64; 2],
    /// Error in the unit of the figure, >= 0.
    pub error: f64,
    /// True when no other of its group is both cheaper and at least as exact.
    pub front: bool,
}

impl Point {
    /// A point that may lie on the front.
    pub fn new(group: &str, method: &str, cost: Cost, error: f64) -> Self {
        let Cost { median, spread } = cost;
        Point { group: group.to_owned(), method: method.to_owned(), cost: median, spread, error, front: false }
    }
}

/// How the points of a group are joined.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Join {
    /// The front is drawn as steps.
    Front,
    /// Every group is a line in the order of its points.
    Lines,
    /// Every group is a function, drawn as a line without marks over straight axes from 0.
    Curves,
}

/// One figure: its points and what they mean.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    /// Name of its files.
    pub name: &'static str,
    /// The line over it.
    pub title: String,
    /// What the horizontal axis shows, with its unit.
    pub cost: String,
    /// What the vertical axis shows, with its unit.
    pub error: String,
    /// What the error is measured against, in a sentence or two.
    pub meaning: String,
    /// How points are joined.
    pub join: Join,
    /// The methods.
    pub points: Vec<Point>,
}

impl Figure {
    /// Marks the front of every group.
    pub fn with_front(mut self) -> Self {
        let marks: Vec<bool> = self.points.iter().map(|p| !self.points.iter().any(|q| beats(q, p))).collect();
        for (point, front) in self.points.iter_mut().zip(marks) {
            point.front = front;
        }
        self
    }

    /// The groups in the order in which they appear.
    pub fn groups(&self) -> Vec<&str> {
        let mut groups: Vec<&str> = Vec::new();
        for point in &self.points {
            if !groups.contains(&point.group.as_str()) {
                groups.push(&point.group);
            }
        }
        groups
    }

    /// The points of the front of a group, cheapest first.
    pub fn front(&self, group: &str) -> Vec<&Point> {
        let mut front: Vec<&Point> = self.points.iter().filter(|p| p.front && p.group == group).collect();
        front.sort_by(|a, b| a.cost.total_cmp(&b.cost));
        front
    }
}

/// Does one method leave no reason to take the other?
fn beats(one: &Point, other: &Point) -> bool {
    let no_worse = one.cost <= other.cost && one.error <= other.error;
    one.group == other.group && no_worse && (one.cost < other.cost || one.error < other.error)
}
