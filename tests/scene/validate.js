// SPDX-License-Identifier: MIT
// Usage: node validate.js INPUT OUTPUT...
//
// Khronos' validator on files: outputs have no error and no warning that the
// input does not have.
const fs = require('fs')
const path = require('path')
const validator = require('gltf-validator')

const beside = file => uri =>
    Promise.resolve(new Uint8Array(fs.readFileSync(
        path.join(path.dirname(file), decodeURIComponent(uri)))))

async function complaints(file) {
    const report = await validator.validateBytes(
        new Uint8Array(fs.readFileSync(file)),
        { maxIssues: 1000, externalResourceFunction: beside(file) })
    return report.issues.messages.filter(m => m.severity < 2)
}

async function main([input, ...outputs]) {
    const known = new Set((await complaints(input)).map(m => m.code))
    let bad = 0
    for (const file of outputs)
        for (const m of await complaints(file))
            if (!known.has(m.code)) {
                console.log(`${file}: ${m.code} ${m.pointer}: ${m.message}`)
                bad++
            }
    process.exit(bad > 0 ? 1 : 0)
}
main(process.argv.slice(2))
