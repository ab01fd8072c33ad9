"""Scenes that author every attribute that the reader reads, each beside a camera and a square that are sound."""

from __future__ import annotations

from sound_neighbour import CAMERA, GOOD

_MESH = """
    int[] faceVertexCounts = [4]
    int[] faceVertexIndices = [0, 1, 2, 3]
    point3f[] points = [(-6, -1, 0), (-4, -1, 0), (-4, 1, 0), (-6, 1, 0)]
"""

MESH = f"""
def Scope "Looks" {{
    def Material "Red" {{
        token outputs:surface.connect = </Looks/Red/Surface.outputs:surface>
        token outputs:displacement.connect = </Looks/Red/Surface.outputs:displacement>
        def Shader "Surface" {{
            uniform token info:id = "UsdPreviewSurface"
            color3f inputs:diffuseColor = (1, 0, 0)
            color3f inputs:emissiveColor.connect = </Looks/Red/Reader.outputs:result>
            float inputs:opacity = 1
            float inputs:opacityThreshold = 0
            normal3f inputs:normal = (0, 0, 1)
            int inputs:useSpecularWorkflow = 0
            float inputs:metallic = 0
            float inputs:roughness = 0.5
            float inputs:ior = 1.5
            float inputs:clearcoat = 0
            float inputs:clearcoatRoughness = 0.01
            token inputs:opacityMode = "transparent"
            float inputs:displacement = 0
            token outputs:surface
            token outputs:displacement
        }}
        def Shader "Reader" {{
            uniform token info:id = "UsdPrimvarReader_float3"
            string inputs:varname = "displayColor"
            float3 inputs:fallback = (0, 1, 0)
            float3 outputs:result
        }}
    }}
}}
def Xform "World" (prepend apiSchemas = ["MotionAPI"]; kind = "group") {{
    token purpose = "default"
    token visibility = "inherited"
    uniform token model:drawMode = "default"
    uniform bool model:applyDrawMode = 1
    float motion:blurScale = 1
    float motion:velocityScale = 1
    int motion:nonlinearSampleCount = 3
    double3 xformOp:translate.timeSamples = {{ 0: (0, 0.5, 0), 2: (0, 0.6, 0) }}
    float3 xformOp:rotateXYZ = (0, 0, 10)
    float3 xformOp:scale = (1, 1, 1)
    matrix4d xformOp:transform = ((1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (0, 0, 0, 1))
    uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:rotateXYZ", "xformOp:scale", "xformOp:transform"]
    def Mesh "Bad" (prepend apiSchemas = ["MaterialBindingAPI"]) {{ {_MESH}
        int[] holeIndices = []
        uniform token subdivisionScheme = "none"
        uniform token orientation = "rightHanded"
        vector3f[] velocities = [(1, 0, 0), (1, 0, 0), (1, 0, 0), (1, 0, 0)]
        vector3f[] accelerations = [(1, 0, 0), (1, 0, 0), (1, 0, 0), (1, 0, 0)]
        normal3f[] normals = [(0, 0, 1), (0, 0, 1), (0, 0, 1), (0, 0, 1)]
        color3f[] primvars:displayColor = [(1, 0, 0)]
        int[] primvars:displayColor:indices = [0]
        float[] primvars:displayOpacity = [1]
        rel material:binding = </Looks/Red>
        def GeomSubset "Part" (prepend apiSchemas = ["MaterialBindingAPI"]) {{
            uniform token elementType = "face"
            uniform token familyName = "materialBind"
            int[] indices = [0]
            rel material:binding = </Looks/Red>
        }}
    }}
    def Mesh "Indexed" {{ {_MESH}
        uniform token subdivisionScheme = "none"
        normal3f[] primvars:normals = [(0, 0, 1)] (interpolation = "vertex")
        int[] primvars:normals:indices = [0, 0, 0, 0]
    }}
}}
"""

SHAPES = "\n".join(
    f'def {kind} "{kind}Bad" {{ {attributes}\n uniform token orientation = "rightHanded"\n'
    ' double3 xformOp:translate = (-5, 0, 0)\n uniform token[] xformOpOrder = ["xformOp:translate"]\n}'
    for kind, attributes in {
        "Sphere": "double radius = 1",
        "Cube": "double size = 1",
        "Cone": 'double radius = 1\n double height = 1\n uniform token axis = "X"',
        "Cylinder": 'double radius = 1\n double height = 1\n uniform token axis = "X"',
        "Capsule": 'double radius = 1\n double height = 1\n uniform token axis = "X"',
        "Plane": 'double width = 1\n double length = 1\n uniform token axis = "X"',
    }.items()
)

SURFACES = """
def Xform "CardsBad" (prepend apiSchemas = ["GeomModelAPI"]; kind = "component") {
    uniform token model:drawMode = "cards"
    uniform token model:cardGeometry = "box"
    uniform token model:cardVisibility = "full"
    uniform float3 model:drawModeColor = (0, 0, 1)
    asset model:cardTextureXPos = @@
    float3[] extentsHint = [(-6, -1, -1), (-4, 1, 1)]
}
def TetMesh "TetsBad" {
    point3f[] points = [(-6, -1, 0), (-4, -1, 0), (-5, 1, 0), (-5, 0, 1)]
    int4[] tetVertexIndices = [(0, 1, 2, 3)]
    int3[] surfaceFaceVertexIndices = [(0, 1, 2)]
    vector3f[] velocities = [(1, 0, 0), (1, 0, 0), (1, 0, 0), (1, 0, 0)]
    uniform token orientation = "rightHanded"
    color3f[] primvars:displayColor = [(1, 0, 0)]
}
def TetMesh "InsideBad" {
    point3f[] points = [(-6, -1, 0), (-4, -1, 0), (-5, 1, 0), (-5, 0, 1)]
    int4[] tetVertexIndices = [(0, 1, 2, 3)]
}
def NurbsPatch "PatchBad" {
    point3f[] points = [(-6, -1, 0), (-4, -1, 0), (-6, 1, 0), (-4, 1, 0)]
    double[] pointWeights = [1, 1, 1, 2]
    int uVertexCount = 2
    int vVertexCount = 2
    int uOrder = 2
    int vOrder = 2
    double[] uKnots = [0, 0, 1, 1]
    double[] vKnots = [0, 0, 1, 1]
    double2 uRange = (0, 1)
    double2 vRange = (0, 1)
    int[] trimCurve:counts = []
    uniform token orientation = "rightHanded"
    color3f[] primvars:displayColor = [(1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 1)] (interpolation = "vertex")
    float[] primvars:displayOpacity = [1]
}
"""

INSTANCER = """
def PointInstancer "Bad" {
    rel prototypes = [</Bad/P>]
    int[] protoIndices = [0, 0]
    point3f[] positions = [(-5, 0, 0), (-5, 2, 0)]
    quatf[] orientationsf = [(1, 0, 0, 0), (1, 0, 0, 0)]
    float3[] scales = [(1, 1, 1), (1, 1, 1)]
    vector3f[] velocities = [(1, 0, 0), (1, 0, 0)]
    vector3f[] accelerations = [(1, 0, 0), (1, 0, 0)]
    vector3f[] angularVelocities = [(1, 0, 0), (1, 0, 0)]
    int64[] ids = [1, 2]
    int64[] invisibleIds = []
    color3f[] primvars:displayColor = [(1, 0, 0), (0, 1, 0)] (interpolation = "vertex")
    float[] primvars:displayOpacity = [1, 1] (interpolation = "vertex")
    def Xform "P" {
        double3 xformOp:translate = (0, 0.5, 0)
        uniform token[] xformOpOrder = ["xformOp:translate"]
        token purpose = "default"
        def Cube "C" {}
        def SphereLight "L" {
            float inputs:intensity = 1
        }
    }
}
def PointInstancer "Half" {
    rel prototypes = [</Bad/P>]
    int[] protoIndices = [0]
    point3f[] positions = [(-5, 0, 0)]
    quath[] orientations = [(1, 0, 0, 0)]
}
"""

LIGHTS = "\n".join(
    f'def {kind} "{kind}Bad" {{ float inputs:intensity = 1\n float inputs:exposure = 0\n'
    " color3f inputs:color = (1, 1, 1)\n bool inputs:enableColorTemperature = 1\n"
    " float inputs:colorTemperature = 5000\n bool inputs:normalize = 1\n float inputs:diffuse = 1\n"
    " bool inputs:shadow:enable = 1\n float inputs:shaping:cone:angle = 90\n float inputs:shaping:focus = 0\n"
    " asset inputs:shaping:ies:file = @@\n bool collection:lightLink:includeRoot = 1\n"
    f" {attributes}\n}}"
    for kind, attributes in {
        "SphereLight": "float inputs:radius = 0.5",
        "RectLight": "float inputs:width = 1\n float inputs:height = 1\n asset inputs:texture:file = @@",
        "DistantLight": "float inputs:angle = 1",
        "DomeLight": "asset inputs:texture:file = @@",
    }.items()
)

SKINNED = f"""
def SkelRoot "Root" {{
    def Skeleton "Skel" (prepend apiSchemas = ["SkelBindingAPI"]) {{
        uniform token[] joints = ["a", "a/b"]
        uniform matrix4d[] bindTransforms = [
            ((1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (0, 0, 0, 1)),
            ((1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (0, 1, 0, 1))]
        uniform matrix4d[] restTransforms = [
            ((1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (0, 0, 0, 1)),
            ((1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (0, 1, 0, 1))]
        rel skel:animationSource = </Root/Anim>
    }}
    def SkelAnimation "Anim" {{
        uniform token[] joints = ["a", "a/b"]
        float3[] translations = [(0, 0, 0), (0, 1, 0)]
        quatf[] rotations = [(1, 0, 0, 0), (1, 0, 0, 0)]
        half3[] scales = [(1, 1, 1), (1, 1, 1)]
        uniform token[] blendShapes = ["wide"]
        float[] blendShapeWeights = [0.5]
    }}
    def Mesh "Bad" (prepend apiSchemas = ["SkelBindingAPI"]) {{ {_MESH}
        uniform token subdivisionScheme = "none"
        int[] primvars:skel:jointIndices = [0, 0, 1, 1] (elementSize = 1; interpolation = "vertex")
        float[] primvars:skel:jointWeights = [1, 1, 1, 1] (elementSize = 1; interpolation = "vertex")
        matrix4d primvars:skel:geomBindTransform = ((1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (0, 0, 0, 1))
        uniform token primvars:skel:skinningMethod = "classicLinear"
        uniform token[] skel:joints = ["a", "a/b"]
        uniform token[] skel:blendShapes = ["wide"]
        rel skel:blendShapeTargets = </Root/Bad/Wide>
        rel skel:skeleton = </Root/Skel>
        def BlendShape "Wide" {{
            uniform vector3f[] offsets = [(1, 0, 0)]
            uniform vector3f[] normalOffsets = [(0, 0, 0)]
            uniform int[] pointIndices = [1]
            uniform vector3f[] inbetweens:half = [(0.2, 0, 0)] (weight = 0.4)
        }}
    }}
}}
"""

LENS = """
    float xformOp:rotateX = 0
    token projection = "perspective"
    float horizontalAperture = 20.955
    float verticalAperture = 15.2908
    float horizontalApertureOffset = 0
    float verticalApertureOffset = 0
    float focalLength = 50
    float2 clippingRange = (1, 1000000)
    float4[] clippingPlanes = [(0, 0, -1, 0)]
    float fStop = 0
    float focusDistance = 20
"""

SCENES = {
    "mesh": CAMERA + GOOD + MESH,
    "shapes": CAMERA + GOOD + SHAPES,
    "surfaces": CAMERA + GOOD + SURFACES,
    "instancer": CAMERA + GOOD + INSTANCER,
    "lights": CAMERA + GOOD + LIGHTS,
    "skinned": CAMERA + GOOD + SKINNED,
    "camera": CAMERA.replace('translate"]', 'translate", "xformOp:rotateX"]').replace("}\n", LENS + "}\n") + GOOD,
}
