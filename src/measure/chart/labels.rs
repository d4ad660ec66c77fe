//! Labels: a place beside each point where a text covers neither points nor other texts, as far as there is one.

/// A rectangle in pixels: left, top, right, bottom.
pub type Frame = [f64; 4];

/// What has to keep clear of each other.
#[derive(Debug)]
pub struct Layout {
    area: Frame,
    taken: Vec<Frame>,
}

/// The directions that are tried, best first: right, left, above, below, and between.
const SIDES: [[f64; 2]; 8] =
    [[1.0, 0.0], [-1.0, 0.0], [0.7, -0.8], [0.7, 0.8], [-0.7, -0.8], [-0.7, 0.8], [0.0, -1.0], [0.0, 1.0]];

impl Layout {
    /// A layout of an area in which points and lines take their room.
    pub fn new(area: Frame, taken: Vec<Frame>) -> Self {
        Layout { area, taken }
    }

    /// Finds a place for a text of this size beside a point and takes it. Near places win over far ones.
    pub fn place(&mut self, at: [f64; 2], size: [f64; 2], gap: f64) -> Frame {
        let mut best = ([0.0; 4], f64::INFINITY);
        for ring in 0..9 {
            let distance = gap * (1.0 + 1.1 * f64::from(ring));
            for (rank, side) in SIDES.iter().enumerate() {
                let frame = beside(at, size, *side, distance);
                let cost = self.covered(frame) + 0.04 * f64::from(ring) + 0.005 * rank as f64;
                if cost < best.1 {
                    best = (frame, cost);
                }
            }
        }
        self.taken.push(best.0);
        best.0
    }

    /// How much of a frame is covered already, in parts of it; what leaves the area counts more.
    fn covered(&self, frame: Frame) -> f64 {
        let size = area(frame).max(1e-9);
        let inside = area(common(frame, self.area)) / size;
        let covered: f64 = self.taken.iter().map(|other| area(common(frame, *other))).sum();
        // A place two rings further out is better than the least overlap.
        let least = if covered > 0.0 { 0.08 } else { 0.0 };
        least + 2.0 * covered / size + 10.0 * (1.0 - inside)
    }
}

fn beside(at: [f64; 2], size: [f64; 2], side: [f64; 2], distance: f64) -> Frame {
    let x = at[0] + side[0] * distance + 0.5 * size[0] * (side[0].signum() * f64::from(side[0] != 0.0) - 1.0);
    let y = at[1] + side[1] * distance + 0.5 * size[1] * (side[1] - 1.0);
    [x, y, x + size[0], y + size[1]]
}

fn common(a: Frame, b: Frame) -> Frame {
    [a[0].max(b[0]), a[1].max(b[1]), a[2].min(b[2]), a[3].min(b[3])]
}

fn area(frame: Frame) -> f64 {
    (frame[2] - frame[0]).max(0.0) * (frame[3] - frame[1]).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_of_a_crowd_do_not_cover_each_other() {
        let mut layout = Layout::new([0.0, 0.0, 400.0, 300.0], Vec::new());
        let frames: Vec<Frame> =
            (0..8).map(|k| layout.place([200.0 + f64::from(k), 150.0], [60.0, 12.0], 8.0)).collect();
        for (k, a) in frames.iter().enumerate() {
            assert!(a[0] >= 0.0 && a[2] <= 400.0);
            assert!(frames[..k].iter().all(|b| area(common(*a, *b)) == 0.0), "{k}");
        }
    }
}
