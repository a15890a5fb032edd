import pytest

from hoblock.cli import main
from hoblock.templates import TEMPLATES


def test_list(capsys):
    assert main(["templates"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in lines[: len(TEMPLATES)]] == list(TEMPLATES)
    assert all(TEMPLATES[line.split()[0]].summary in line for line in lines[: len(TEMPLATES)])


@pytest.mark.parametrize("name", TEMPLATES)
def test_description_has_every_parameter(name, capsys):
    assert main(["templates", name]) == 0
    out = capsys.readouterr().out
    assert TEMPLATES[name].summary in out
    words = " ".join(out.split())
    for parameter in TEMPLATES[name].parameters.values():
        default = "" if parameter.default is None else f"{parameter.default!r}. "
        assert f"{parameter.name} {default}{parameter.meaning}" in words


@pytest.mark.parametrize("name", TEMPLATES)
def test_each_parameter_has_its_own_meaning(name):
    meanings = [parameter.meaning for parameter in TEMPLATES[name].parameters.values()]
    assert sorted(meanings) == sorted(set(meanings))
    assert all(meanings)


@pytest.mark.parametrize("name", TEMPLATES)
def test_written_scene_is_accepted(name, tmp_path, capsys):
    path = tmp_path / f"{name}.toml"
    assert main(["templates", name, "-o", str(path)]) == 0
    assert f"wrote {path}" in capsys.readouterr().out
    assert main(["check", str(path), "--order", "2"]) == 0
    assert "certified" in capsys.readouterr().out


def test_a_file_is_written_over_only_on_request(tmp_path, capsys):
    path = tmp_path / "mine.toml"
    path.write_text("precious", encoding="utf-8")
    assert main(["templates", "disc", "-o", str(path)]) == 2
    assert "mine.toml exists; choose another name, or write over it with --force" in capsys.readouterr().err
    assert path.read_text(encoding="utf-8") == "precious"
    assert main(["templates", "disc", "-o", str(path), "--force"]) == 0
    assert 'name = "disc"' in path.read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["naca"], "hoblock: there is no template 'naca'."),
        (["anulus"], "hoblock: there is no template 'anulus'. Did you mean 'annulus'? Templates: 'annulus', "),
        (["-o", "a.toml"], "hoblock: templates: -o needs the name of a template"),
        (["disc", "-o", "disc.msh"], "hoblock: templates: disc.msh: suffix is '.msh'; a scene file ends in .toml."),
    ],
)
def test_mistakes(arguments, message, capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main(["templates", *arguments]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.startswith(message)
    assert list(tmp_path.iterdir()) == []
