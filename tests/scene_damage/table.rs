//! The damages: a sound scene, and what to break in it with what is to be said of that.

/// Uses every part of the format.
pub(crate) const GOOD: &str = include_str!("../data/all.toml");

/// What to replace by what in [`GOOD`], `§` marking where the error is expected (see [`AFTER`] where
/// that is elsewhere), and the codes in the order of the places.
pub(crate) const DAMAGE: &[(&str, &str, &[&str])] = &[
    // Syntax.
    ("friction = \"1/4\"", "friction = §", &["syntax"]),
    ("friction = \"1/4\"", "friction = §1/4", &["syntax"]),
    ("name = \"all\"", "name = \"all§", &["syntax"]),
    ("reverse = true", "reverse = §maybe", &["syntax"]),
    ("[root]", "[root§\n", &["syntax"]),
    (
        "total = true",
        "total = true\n§total = true",
        &["duplicate-key"],
    ),
    ("[classify]", "[§scene]\n[classify]", &["duplicate-key"]),
    // Keys.
    ("friction = ", "§frction = ", &["unknown-key"]),
    ("stiffness = \"2\"", "§Stiffness = \"2\"", &["unknown-key"]),
    ("start = ", "§begin = ", &["unknown-key"]),
    ("reference = ", "§refrence = ", &["unknown-key"]),
    ("holes = ", "§hole = ", &["unknown-key"]),
    ("force_limit = ", "§force-limit = ", &["unknown-key"]),
    ("[classify]", "[§klassify]", &["unknown-key"]),
    ("duration = \"12\"", "§durations = \"12\"", &["unknown-key"]),
    (
        "reverse = true",
        "reverse = true\n§speed = 2",
        &["unknown-key"],
    ),
    ("[scene]\nname = \"all\"", "§[scene]", &["missing-key"]),
    (
        "[[obstacle]]\nname = \"plate\"",
        "§[[obstacle]]",
        &["missing-key"],
    ),
    ("[[pawl]]\nname = \"left\"", "§[[pawl]]", &["missing-key"]),
    (
        "[[pawl]]\nname = \"left\"\nhinge = [\"0\",\"6\"]",
        "§[[pawl]]\nname = \"left\"",
        &["missing-key"],
    ),
    (
        "[[motion]]\nvelocity = [\"0\",\"-1\"]",
        "§[[motion]]",
        &["missing-key"],
    ),
    (
        "[root]\nvertices = [[\"-2\",\"10\"], [\"2\",\"10\"], [\"2\",\"12\"], [\"-2\",\"12\"]]",
        "§[root]",
        &["missing-key"],
    ),
    // A slip is not also something missing.
    (
        "vertices = [[12, 0]",
        "§vertice = [[12, 0]",
        &["unknown-key"],
    ),
    (
        "duration = \"12\"\nuntil = ",
        "§Duration = \"12\"\n§untill = ",
        &["unknown-key", "unknown-key"],
    ),
    (
        "hinge = [\"0\",\"6\"]",
        "§hinges = [\"0\",\"6\"]",
        &["unknown-key"],
    ),
    ("[classify]", "[[§motions]]\n[classify]", &["unknown-key"]),
    // Types.
    ("name = \"all\"", "name = §12", &["wrong-type"]),
    ("name = \"block\"", "name = §[\"block\"]", &["wrong-type"]),
    ("friction = \"1/4\"", "friction = §true", &["wrong-type"]),
    (
        "friction = \"1/4\"",
        "friction = §1979-05-27",
        &["wrong-type"],
    ),
    ("hinge = [\"0\",\"6\"]", "hinge = §\"0,6\"", &["wrong-type"]),
    (
        "hinge = [\"0\",\"6\"]",
        "hinge = §[\"0\",\"6\",\"0\"]",
        &["wrong-type"],
    ),
    (
        "[\"1\",\"3\"], [\"-1\",\"3\"]",
        "§[\"1\"], [\"-1\",\"3\"]",
        &["wrong-type"],
    ),
    (
        "[\"1\",\"3\"], [\"-1\",\"3\"]",
        "§\"1\", §\"3\", [\"-1\",\"3\"]",
        &["wrong-type", "wrong-type"],
    ),
    (
        "limits = [\"-1/2\", \"1/2\"]",
        "limits = §[\"1/2\"]",
        &["wrong-type"],
    ),
    (
        "limits = [\"-1/2\", \"1/2\"]",
        "limits = §\"1/2\"",
        &["wrong-type"],
    ),
    ("total = true", "total = §\"true\"", &["wrong-type"]),
    (
        "directions = [[\"0\",\"1\"], [\"1\",\"1\"]]",
        "directions = §3",
        &["wrong-type"],
    ),
    ("[root]", "§[[root]]", &["wrong-type"]),
    (
        "until = \"root-collision\"",
        "until = §true",
        &["wrong-type"],
    ),
    // Numbers.
    (
        "friction = \"1/4\"",
        "friction = §\"1 / 4\"",
        &["malformed-number"],
    ),
    (
        "friction = \"1/4\"",
        "friction = §\"\"",
        &["malformed-number"],
    ),
    (
        "friction = \"1/4\"",
        "friction = §\"0,25\"",
        &["malformed-number"],
    ),
    (
        "friction = \"1/4\"",
        "friction = §\".25\"",
        &["malformed-number"],
    ),
    (
        "friction = \"1/4\"",
        "friction = §0x10",
        &["malformed-number"],
    ),
    (
        "friction = \"1/4\"",
        "friction = §1_000",
        &["malformed-number"],
    ),
    (
        "friction = \"1/4\"",
        "friction = §inf",
        &["malformed-number"],
    ),
    (
        "friction = \"1/4\"",
        "friction = §nan",
        &["malformed-number"],
    ),
    ("[\"6\",\"3e0\"]", "[\"6\",§\"3e\"]", &["malformed-number"]),
    ("[12, 0]", "[§\"1é2\", 0]", &["malformed-number"]),
    (
        "friction = \"1/4\"",
        "friction = §\"1/0\"",
        &["bad-denominator"],
    ),
    (
        "start = \"1/10\"",
        "start = §\"1/-10\"",
        &["bad-denominator"],
    ),
    (
        "[12, 0], [14, 0]",
        "[§\"12/0\", 0], [§\"14/0\", 0]",
        &["bad-denominator", "bad-denominator"],
    ),
    (
        "duration = \"12\"",
        "duration = §\"1e100001\"",
        &["number-too-large"],
    ),
    (
        "stiffness = 0.5",
        "stiffness = §1e-999999",
        &["number-too-large"],
    ),
    // Polygons.
    (
        "[\"0\",\"6\"], [\"1\",\"3\"], [\"-1\",\"3\"]",
        "§[\"0\",\"6\"], [\"1\",\"3\"]",
        &["too-few-vertices"],
    ),
    (
        "[\"0\",\"6\"], [\"1\",\"3\"], [\"-1\",\"3\"]",
        "§",
        &["too-few-vertices"],
    ),
    (
        "[\"1\",\"3\"], [\"-1\",\"3\"]",
        "[\"1\",\"3\"], §[\"1\",\"3\"], [\"-1\",\"3\"]",
        &["zero-length-edge"],
    ),
    (
        "[14, 3], [12, 3]",
        "[14, 3], §[14, 3.0], [12, 3]",
        &["zero-length-edge"],
    ),
    (
        "[[12, 0], [14, 0], [14, 3], [12, 3]]",
        "[§[12, 0], [14, 0], [14, 3], [12, 3], [12, 0]]",
        &["zero-length-edge"],
    ),
    (
        "[\"1\",\"3\"], [\"-1\",\"3\"]",
        "[\"0\",\"5\"], [\"0\",\"3\"]",
        &["zero-area"],
    ),
    (
        "[[12, 0], [14, 0], [14, 3], [12, 3]]",
        "[§[12, 0], [14, 3], [14, 0], [12, 3]]",
        &["edges-meet"],
    ),
    (
        "[[12, 0], [14, 0], [14, 3], [12, 3]]",
        "[§[12, 0], [14, 0], [14, 3], [12, 3], [13, -1]]",
        &["edges-meet"],
    ),
    (
        "[14, 3], [12, 3]",
        "§§[14, 3], [12, 3], [13, 3.5], [14, 4], [13, 3]",
        &["edges-meet", "edges-meet"],
    ),
    (
        "[14, 3], [12, 3]",
        "[14, 3], §[14, 9], [14, 4], [12, 3]",
        &["spike"],
    ),
    (
        "[\"-2\",\"-3\"], [\"2\",\"-3\"]",
        "[\"-2\",\"-3\"]",
        &["too-few-vertices"],
    ),
    ("[\"0\",\"-1\"]]", "[\"0\",\"-3\"]]", &["zero-area"]),
    (
        "[[\"4\",\"-3\"], [\"6\",\"-3\"], [\"5\",\"-1\"]]",
        "§[[\"24\",\"-3\"], [\"26\",\"-3\"], [\"25\",\"-1\"]]",
        &["hole-outside"],
    ),
    (
        "[[\"4\",\"-3\"], [\"6\",\"-3\"], [\"5\",\"-1\"]]",
        "§[[\"-1\",\"-2.5\"], [\"1\",\"-2.5\"], [\"0\",\"-2\"]]",
        &["holes-overlap"],
    ),
    // Meaning.
    (
        "friction = \"1/4\"",
        "friction = §\"-1/4\"",
        &["friction-negative"],
    ),
    (
        "stiffness = \"2\"",
        "stiffness = §\"0\"",
        &["stiffness-not-positive"],
    ),
    (
        "stiffness = 0.5",
        "stiffness = §-0.5",
        &["stiffness-not-positive"],
    ),
    ("name = \"block\"", "name = §\"plate\"", &["duplicate-name"]),
    ("name = \"right\"", "name = §\"left\"", &["duplicate-name"]),
    (
        "limits = [\"-1/2\", \"1/2\"]",
        "limits = §[\"1/2\", \"-1/2\"]",
        &["limits-order"],
    ),
    (
        "limits = [\"-1/2\", \"1/2\"]",
        "limits = §[\"1/10\", \"0.1\"]",
        &["limits-order"],
    ),
    (
        "start = \"1/10\"",
        "start = §\"51/100\"",
        &["start-outside-limits"],
    ),
    (
        "start = \"1/10\"",
        "start = §\"0.50000000000000000000000000001\"",
        &["start-outside-limits"],
    ),
    (
        "limits = [\"-1/2\", \"1/2\"]",
        "limits = [\"1/5\", \"1/2\"]",
        &["start-outside-limits"],
    ),
    (
        "velocity = [\"0\",\"-1\"]",
        "velocity = §[\"0\",\"0/5\"]",
        &["zero-velocity"],
    ),
    (
        "duration = \"12\"",
        "duration = §\"0\"",
        &["duration-not-positive"],
    ),
    (
        "duration = \"12\"",
        "duration = §-12",
        &["duration-not-positive"],
    ),
    (
        "[[motion]]\nvelocity = [\"0\",\"-1\"]\nduration = \"12\"\nuntil = \"root-collision\"",
        "§[[motion]]\nvelocity = [\"0\",\"-1\"]",
        &["endless-motion"],
    ),
    (
        "until = \"root-collision\"",
        "until = §\"root collision\"",
        &["unknown-until"],
    ),
    (
        "[[motion]]\nvelocity",
        "[[motion]]\nreverse = §true\n[[motion]]\nvelocity",
        &["reverse-first"],
    ),
    ("reverse = true", "reverse = §false", &["reverse-false"]),
    ("reverse = true", "reverse = §1", &["reverse-false"]),
    (
        "reverse = true",
        "reverse = true\n§duration = \"2\"",
        &["reverse-not-alone"],
    ),
    (
        "reverse = true",
        "§velocity = [0, 1]\nreverse = true",
        &["reverse-not-alone"],
    ),
    (
        "[\"1\",\"1\"]]\ntotal",
        "§[\"0\",\"0\"]]\ntotal",
        &["zero-direction"],
    ),
    (
        "force_limit = \"5\"",
        "force_limit = §\"-5\"",
        &["limit-not-positive"],
    ),
    (
        "escape_distance = \"100\"",
        "escape_distance = §\"0\"",
        &["limit-not-positive"],
    ),
    // Starting positions.
    (
        "[\"-2\",\"10\"], [\"2\",\"10\"]",
        "[\"-2\",\"-1\"], [\"2\",\"-1\"]",
        &["start-penetrates"],
    ),
    (
        "[\"5\",\"6.5\"], [\"6\",\"3e0\"], [\"4\",\"3\"]",
        "[\"5\",\"6.5\"], [\"6\",\"-0.5\"], [\"4\",\"3\"]",
        &["start-penetrates"],
    ),
    (
        "[12, 0], [14, 0], [14, 3], [12, 3]",
        "[1, 4], [1, 5], [3, 5], [3, 4]",
        &["start-penetrates"],
    ),
    // Several at once, in the order of the file.
    (
        "stiffness = \"2\"\nstart = \"1/10\"\nlimits = [\"-1/2\", \"1/2\"]",
        "stiffness = §\"-2\"\nstart = §\"ten\"\nlimits = §[2, 1]\n§limit = 3",
        &[
            "stiffness-not-positive",
            "malformed-number",
            "limits-order",
            "unknown-key",
        ],
    ),
    (
        "friction = \"1/4\"\n\n[[obstacle]]\nname = \"plate\"",
        "friction = §\"1/0\"\n\n[[obstacle]]\nname = \"plate\"\n§colour = \"red\"",
        &["bad-denominator", "unknown-key"],
    ),
];

/// Where a place that the damage does not mark is expected: the value after this text.
pub(crate) const AFTER: &[(&str, &str)] = &[
    // The ring as a whole.
    (
        "[\"0\",\"5\"], [\"0\",\"3\"]",
        "vertices = §[[\"0\",\"6\"], [\"0\",\"5\"]",
    ),
    (
        "[\"0\",\"-3\"]]",
        "holes = [§[[\"-2\",\"-3\"], [\"2\",\"-3\"], [\"0\",\"-3\"]]",
    ),
    (
        "[\"-2\",\"-3\"]",
        "holes = [§[[\"-2\",\"-3\"], [\"0\",\"-1\"]]",
    ),
    (
        "§[\"0\",\"6\"], [\"1\",\"3\"]",
        "vertices = §[[\"0\",\"6\"], [\"1\",\"3\"]]",
    ),
    ("§", "vertices = §[]"),
    // What put the body there.
    ("limits = [\"1/5\", \"1/2\"]", "start = §\"1/10\""),
    (
        "[\"-2\",\"-1\"], [\"2\",\"-1\"]",
        "vertices = §[[\"-2\",\"-1\"]",
    ),
    (
        "[\"5\",\"6.5\"], [\"6\",\"-0.5\"], [\"4\",\"3\"]",
        "vertices = §[[\"5\",\"6.5\"]",
    ),
    ("[1, 4], [1, 5], [3, 5], [3, 4]", "start = §\"1/10\""),
];
