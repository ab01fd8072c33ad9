"""MaterialX documents as USD layers, which usd-core has no file format plugin for.

As UsdMtlx does: a Material each under /MaterialX/Materials, with `outputs:mtlx:surface`, and in it the nodes and node
graphs that it reads. Looks, collections and definitions of nodes are left out.
"""

from __future__ import annotations

import posixpath
from functools import cache
from pathlib import PurePath
from typing import Any

from pxr import Ar, Gf, Sdf, Tf

MATERIALS = Sdf.Path("/MaterialX/Materials")
_T = Sdf.ValueTypeNames
_TYPES = {
    "float": _T.Float,
    "integer": _T.Int,
    "boolean": _T.Bool,
    "color3": _T.Color3f,
    "color4": _T.Color4f,
    "vector2": _T.Float2,
    "vector3": _T.Float3,
    "vector4": _T.Float4,
    "string": _T.String,
    "filename": _T.Asset,
    "matrix33": _T.Matrix3d,
    "matrix44": _T.Matrix4d,
}
"""Others, such as surfaceshader, are tokens."""
_TERMINALS = {"surfaceshader": "surface", "displacementshader": "displacement", "volumeshader": "volume"}


class DocumentFault(Exception):
    """A document cannot be read; str() says why."""


def layer_of(resolved: str) -> Sdf.Layer:
    """An anonymous layer of the document in a resolved file, in a package or not. Files of images have absolute paths.
    Raises DocumentFault, and ImportError without the package MaterialX."""
    import MaterialX as mx

    document = mx.createDocument()
    folders = mx.FileSearchPath(str(mx.FilePath(resolved).getParentPath()))
    try:
        if Ar.IsPackageRelativePath(resolved):
            asset = Ar.GetResolver().OpenAsset(Ar.ResolvedPath(resolved))
            if not asset or not asset.GetSize():
                raise DocumentFault("there is no such file, or an empty one")
            mx.readFromXmlString(document, bytes(asset.GetBuffer()).decode("utf-8"), folders)
        else:
            mx.readFromXmlFile(document, resolved, folders)
        document.importLibrary(_library())
        return _Writer(document, resolved).layer()
    except (mx.Exception, mx.ExceptionParseError, mx.ExceptionFileMissing, LookupError, ValueError) as error:
        # LookupError: what others of MaterialX's exceptions arrive as.
        raise DocumentFault(" ".join(str(error).split())) from None


@cache
def _library() -> Any:
    """What MaterialX's own nodes are called in which of their forms."""
    import MaterialX as mx

    library = mx.createDocument()
    mx.loadLibraries(mx.getDefaultDataLibraryFolders(), mx.getDefaultDataSearchPath(), library)
    return library


class _Writer:
    """Writes a document's materials."""

    def __init__(self, document: Any, resolved: str) -> None:
        self._document = document
        self._resolved = resolved
        inner = Ar.SplitPackageRelativePathInner(resolved)[1] or resolved
        self._layer = Sdf.Layer.CreateAnonymous(PurePath(inner).stem)  # with its extension it could not be referred to

    def layer(self) -> Sdf.Layer:
        with Sdf.ChangeBlock():
            self._prim(MATERIALS.GetParentPath(), "")
            self._prim(MATERIALS, "Scope")
            for node in self._document.getMaterialNodes():
                self._material(node)
        return self._layer

    def _prim(self, path: Sdf.Path, kind: str) -> bool:
        """Whether it is new."""
        if self._layer.GetPrimAtPath(path):
            return False
        spec = Sdf.CreatePrimInLayer(self._layer, path)
        spec.specifier = Sdf.SpecifierDef
        if kind:
            spec.typeName = kind
        return True

    def _material(self, node: Any) -> None:
        path = _child(MATERIALS, node.getName())
        if not self._prim(path, "Material"):
            return
        for given in node.getInputs():
            terminal = _TERMINALS.get(given.getType())
            source = self._source(given, path, None) if terminal else None
            if source is not None:
                self._attribute(path, f"outputs:mtlx:{terminal}", _T.Token).connectionPathList.prependedItems = [source]

    def _source(self, given: Any, scope: Sdf.Path, graph: Any) -> Sdf.Path | None:
        """The attribute that an input is connected to, whose prim is written below `scope`; None: it holds a value."""
        name = given.getNodeGraphString()
        if name and given.getType():
            found = self._document.getNodeGraph(name)
            if found is not None:
                output = given.getOutputString() or next((each.getName() for each in found.getOutputs()), "out")
                return self._graph(found, scope).AppendProperty(f"outputs:{output}")
        if given.getInterfaceName() and graph is not None:
            return scope.AppendProperty(f"inputs:{given.getInterfaceName()}")
        name = given.getNodeName()
        found = (graph or self._document).getNode(name) if name else None
        if found is None:
            return None
        output = given.getOutputString() or "out"
        path = self._node(found, scope, graph)
        self._attribute(path, f"outputs:{output}", _type(found.getType()))
        return path.AppendProperty(f"outputs:{output}")

    def _node(self, node: Any, scope: Sdf.Path, graph: Any) -> Sdf.Path:
        path = _child(scope, node.getName())
        if self._prim(path, "Shader"):
            definition = node.getNodeDef()
            name = definition.getName() if definition else f"ND_{node.getCategory()}_{node.getType()}"
            identifier = self._attribute(path, "info:id", _T.Token, Sdf.VariabilityUniform)
            identifier.default = name
            for given in node.getInputs():
                self._input(given, path, self._source(given, scope, graph), node.getType())
        return path

    def _graph(self, graph: Any, scope: Sdf.Path) -> Sdf.Path:
        path = _child(scope, graph.getName())
        if self._prim(path, "NodeGraph"):
            for given in graph.getInputs():
                self._input(given, path, self._source(given, scope, None), given.getType())
            for output in graph.getOutputs():
                source = self._source(output, path, graph)
                attribute = self._attribute(path, f"outputs:{output.getName()}", _type(output.getType()))
                if source is not None:
                    attribute.connectionPathList.prependedItems = [source]
        return path

    def _input(self, given: Any, path: Sdf.Path, source: Sdf.Path | None, of: str) -> None:
        """`of`: the type of the node, which says what the file of an image holds."""
        kind = _type(given.getType())
        attribute = self._attribute(path, f"inputs:{given.getName()}", kind)
        if source is not None:
            attribute.connectionPathList.prependedItems = [source]
            return
        text = given.getResolvedValueString(given.createStringResolver())
        if kind == _T.Asset:
            if text:
                attribute.default = Sdf.AssetPath(self._anchored(text))
        else:
            found = _value(given.getValue(), text, kind)
            if found is not None:
                attribute.default = found
        color = of if kind == _T.Asset else given.getType()
        if color in ("color3", "color4") and given.getActiveColorSpace():
            attribute.SetInfo("colorSpace", given.getActiveColorSpace())

    def _anchored(self, file: str) -> str:
        """A file beside the document, in its package or not; what is absolute, or an address, stays."""
        if PurePath(file).is_absolute() or ":" in file:
            return file
        package, inner = Ar.SplitPackageRelativePathInner(self._resolved)
        beside = posixpath.normpath(posixpath.join(posixpath.dirname(inner or package), file))
        return Ar.JoinPackageRelativePath([package, beside]) if inner else beside

    def _attribute(
        self, path: Sdf.Path, name: str, kind: Sdf.ValueTypeName, variability: Any = Sdf.VariabilityVarying
    ) -> Sdf.AttributeSpec:
        known = self._layer.GetAttributeAtPath(path.AppendProperty(name))
        return known or Sdf.AttributeSpec(self._layer.GetPrimAtPath(path), name, kind, variability)


def _child(path: Sdf.Path, name: str) -> Sdf.Path:
    return path.AppendChild(Tf.MakeValidIdentifier(name))


def _type(name: str) -> Sdf.ValueTypeName:
    return _TYPES.get(name, _T.Token)


def _value(value: Any, text: str, kind: Sdf.ValueTypeName) -> Any:
    """A value of MaterialX's as one of USD's type; None: it has none."""
    if kind in (_T.String, _T.Token):
        return text or None
    if value is None:
        return None
    if kind in (_T.Float, _T.Int, _T.Bool):
        return value
    numbers = [float(part) for part in text.split(",")]
    if kind in (_T.Matrix3d, _T.Matrix4d):
        return (Gf.Matrix3d if kind == _T.Matrix3d else Gf.Matrix4d)(*numbers)
    vectors = {2: Gf.Vec2f, 3: Gf.Vec3f, 4: Gf.Vec4f}
    return vectors[len(numbers)](*numbers)
