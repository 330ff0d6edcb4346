//! JSON that both people and line-based tools can read: a value that fits stands on one line.

/// Lays out compact JSON: what fits within `width` columns stays on its line, anything longer is
/// opened one item a line. The order of keys is kept. Cost: linear.
///
/// ```
/// let open = snapfit::report::pretty(r#"{"a":[1,2],"b":{"c":"long enough"}}"#, 24);
/// assert_eq!(open, "{\n  \"a\": [1, 2],\n  \"b\": {\n    \"c\": \"long enough\"\n  }\n}");
/// ```
pub fn pretty(compact: &str, width: usize) -> String {
    let text = compact.as_bytes();
    let ends = group_ends(text);
    let mut out = String::with_capacity(2 * compact.len());
    let mut open: Vec<bool> = Vec::new();
    let mut column = 0;
    let mut i = 0;
    while i < text.len() {
        match text[i] {
            b'"' => {
                let end = string_end(text, i);
                let piece = &compact[i..end];
                out.push_str(piece);
                column += piece.chars().count();
                i = end;
                continue;
            }
            c @ (b'{' | b'[') => {
                let outer = open.last().copied().unwrap_or(true);
                let short = !outer || column + spaced_len(text, i, ends[i]) <= width;
                let broken = !short && ends[i] > i + 1;
                open.push(broken);
                out.push(char::from(c));
                column += 1;
                if broken {
                    column = new_line(&mut out, depth(&open));
                }
            }
            c @ (b'}' | b']') => {
                if open.pop().unwrap_or(false) {
                    column = new_line(&mut out, depth(&open));
                }
                out.push(char::from(c));
                column += 1;
            }
            b',' => {
                out.push(',');
                if open.last().copied().unwrap_or(false) {
                    column = new_line(&mut out, depth(&open));
                } else {
                    out.push(' ');
                    column += 2;
                }
            }
            b':' => {
                out.push_str(": ");
                column += 2;
            }
            c => {
                out.push(char::from(c));
                column += 1;
            }
        }
        i += 1;
    }
    out
}

fn depth(open: &[bool]) -> usize {
    open.iter().filter(|b| **b).count()
}

fn new_line(out: &mut String, depth: usize) -> usize {
    out.push('\n');
    for _ in 0..depth {
        out.push_str("  ");
    }
    2 * depth
}

/// The index just past the string that begins at i.
fn string_end(text: &[u8], i: usize) -> usize {
    let mut k = i + 1;
    while k < text.len() && text[k] != b'"' {
        k += if text[k] == b'\\' { 2 } else { 1 };
    }
    (k + 1).min(text.len())
}

/// For every opening bracket the place of its closing one.
fn group_ends(text: &[u8]) -> Vec<usize> {
    let mut ends = vec![0; text.len()];
    let mut stack = Vec::new();
    let mut i = 0;
    while i < text.len() {
        match text[i] {
            b'"' => {
                i = string_end(text, i);
                continue;
            }
            b'{' | b'[' => stack.push(i),
            b'}' | b']' => {
                if let Some(start) = stack.pop() {
                    ends[start] = i;
                }
            }
            _ => {}
        }
        i += 1;
    }
    ends
}

/// About how many columns a group takes on one line (separators with their blanks).
fn spaced_len(text: &[u8], from: usize, to: usize) -> usize {
    let group = &text[from..=to];
    // Each comma and colon outside a string brings a blank; within strings they are rare, and
    // counting them too only breaks a line early. Stop where the answer is known.
    let limit = 400;
    if group.len() > limit {
        return group.len();
    }
    group.len() + group.iter().filter(|c| matches!(c, b',' | b':')).count()
}

#[cfg(test)]
mod tests {
    use super::pretty;

    #[test]
    fn the_same_value_in_other_clothes() {
        let compact = r#"{"a":[],"b":{},"c":"x:,{[\"é","d":[[1,2],[3,[4.5,null]]],"e":true}"#;
        for width in [0, 10, 20, 40, 200] {
            let again: serde_json::Value =
                serde_json::from_str(&pretty(compact, width)).expect("JSON");
            assert_eq!(
                again,
                serde_json::from_str::<serde_json::Value>(compact).expect("JSON")
            );
        }
        assert!(!pretty(compact, 200).contains('\n'));
    }
}
