"""Pages of single fits, from the commands to the file."""

from fitter.__main__ import main


def run(capsys, *arguments):
    """Run ``fitter``, which must end well; return stdout and stderr."""
    assert main([str(argument) for argument in arguments]) == 0
    return capsys.readouterr()


def test_a_fit_of_the_dynamics_has_a_page(trial_files, tmp_path, capsys):
    learn, evaluate = trial_files
    page = tmp_path / "new" / "page.html"
    common = ("--arm", "dd-arm", "--method", "least-squares", "--objective", "torque", "--cutoff-hz", 20)
    out = tmp_path / "arm.toml"
    said = run(capsys, "dynamics", learn, "--evaluate", evaluate, *common, "--out", out, "--report", page)
    text = page.read_text(encoding="utf-8")
    assert f"report: {page}" in " ".join(said.out.split()) and "I1+m2*L1^2" in said.out
    for words in ("2 trials (", "1 held back", "eq. (5)", "Lengths are taken from the arm file", str(learn)):
        assert words in text, words
    assert "fitter dynamics" in text and "the paper" in text and text.count("data:image/png") == 3


def test_a_fit_of_the_geometry_has_a_page(recording, tmp_path, capsys):
    page = tmp_path / "page.html"
    run(capsys, "kinematics", recording, "--arm", "dd-arm", "--out", tmp_path / "arm.toml", "--report", page)
    text = page.read_text(encoding="utf-8")
    for words in ("theta_offset_j", "tip&#x27;s displacement, mean [mm]", "s1 on link 1", "day.mcap"):
        assert words in text, words


def test_a_page_is_refused_where_it_could_not_be_written(trial_files, tmp_path, capsys):
    common = ("dynamics", trial_files[0], "--arm", "dd-arm", "--out", tmp_path / "arm.toml", "--report")
    for more, words in (
        (("page.pdf",), "the suffix is '.pdf'"),
        (("page.html", "--unknown-gains"), "--report shows no gains"),
        (("page.html", "--workers", "2"), "which sums no longer hold"),
    ):
        assert main([str(a) for a in (*common, tmp_path / more[0], *more[1:])]) == 2
        assert words in capsys.readouterr().err
